#include "services/demonstration/core/recognition/distribution.hpp"

#include <cmath>

namespace prehend::demonstration {

Distribution distribution_of(const Eigen::VectorXd& scores, double temperature) {
  const Eigen::VectorXd powers = ((scores.array() - scores.maxCoeff()) / temperature).exp();
  return powers / powers.sum();
}

Expected<Distribution> with_prior(const Distribution& p, const Eigen::VectorXd& prior) {
  if (prior.size() != p.size() || !prior.allFinite() || (prior.array() < 0).any())
    return fail("a prior needs one number from 0 up for each class");
  const double most = prior.maxCoeff();
  if (most <= 0) return fail("the prior forbids every class");
  Distribution made = p.cwiseProduct(prior / most);
  const double sum = made.sum();
  if (!(sum > 0)) return fail("the prior forbids all that was possible");
  return Distribution(made / sum);
}

Decision decide(const Distribution& p, double min_probability) {
  Eigen::Index best = 0;
  Decision made;
  made.probability = p.maxCoeff(&best);
  if (made.probability >= min_probability) made.best = best;
  return made;
}

double calibrated_temperature(const Eigen::MatrixXd& scores, const Eigen::VectorXi& truths) {
  if (scores.cols() == 0) return 1;
  const auto loss = [&](double log_temperature) {
    const double temperature = std::exp(log_temperature);
    double sum = 0;
    for (Eigen::Index i = 0; i < scores.cols(); ++i) {
      const Eigen::ArrayXd scaled =
          (scores.col(i).array() - scores.col(i).maxCoeff()) / temperature;
      sum += std::log(scaled.exp().sum()) - scaled[truths[i]];
    }
    return sum;
  };
  // The loss has one minimum over 1 / T, so also over log T: golden section.
  constexpr double golden = 0.6180339887498949;
  double low = std::log(0.05), high = std::log(20.0);
  double a = high - golden * (high - low), b = low + golden * (high - low);
  double loss_a = loss(a), loss_b = loss(b);
  while (high - low > 1e-3) {
    if (loss_a < loss_b) {
      high = b, b = a, loss_b = loss_a;
      loss_a = loss(a = high - golden * (high - low));
    } else {
      low = a, a = b, loss_a = loss_b;
      loss_b = loss(b = low + golden * (high - low));
    }
  }
  return std::exp((low + high) / 2);
}

}  // namespace prehend::demonstration
