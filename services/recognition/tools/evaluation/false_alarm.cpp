#include "services/recognition/tools/evaluation/false_alarm.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::recognition {

FalseAlarm::FalseAlarm(const ObjectModels& models) : views_(models.classes.size()) {
  for (std::size_t c = 0; c < models.classes.size(); ++c) {
    std::vector<Eigen::Index> own, others;
    for (Eigen::Index i = 0; i < models.views.cols(); ++i)
      (models.view_class[static_cast<std::size_t>(i)] == static_cast<int>(c) ? own : others)
          .push_back(i);
    if (others.empty()) others = own;
    const Eigen::MatrixXf strangers = models.views(Eigen::all, others);
    const Eigen::VectorXf mean = strangers.rowwise().mean();
    const Eigen::VectorXf variance =
        (strangers.colwise() - mean).array().square().rowwise().mean().matrix();
    for (const Eigen::Index i : own) {
      const auto view = models.views.col(i);
      const double spread = view.cwiseProduct(view).dot(variance);
      views_[c].push_back({view.dot(mean), std::sqrt(std::max(1e-12, spread))});
    }
  }
}

double FalseAlarm::probability(int class_index, double similarity) const {
  double none = 1;  // that no view of the class is reached
  for (const Normal& view : views_[static_cast<std::size_t>(class_index)])
    none *= 0.5 * std::erfc((view.mean - similarity) / view.deviation / std::sqrt(2.0));
  return 1 - none;
}

}  // namespace prehend::recognition
