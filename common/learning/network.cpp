#include "network.hpp"

#include <fmt/format.h>

#include <cmath>

namespace prehend::learning {

namespace {
constexpr double steepness = 0.5;
}

Expected<Network> Network::create(std::vector<Layer> layers) {
  if (layers.empty()) return fail("a network has no layers");
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const Layer& layer = layers[i];
    if (layer.rows() < 1 || layer.cols() < 2) return fail(fmt::format("layer {} is empty", i));
    if (i > 0 && layer.cols() != layers[i - 1].rows() + 1)
      return fail(fmt::format("layer {} takes {} numbers and gets {}", i, layer.cols() - 1,
                              layers[i - 1].rows()));
    if (!layer.allFinite()) return fail(fmt::format("layer {} has weights that are not finite", i));
  }
  return Network(std::move(layers));
}

Eigen::VectorXd Network::evaluate(const Eigen::VectorXd& x) const {
  Eigen::VectorXd y = x;
  for (const Layer& layer : layers_) {
    const auto n = layer.cols() - 1;
    // Written as FANN writes it, so that training and use agree to the last bits.
    y = (layer.leftCols(n) * y + layer.col(n)).eval().unaryExpr([](double sum) {
      return 2.0 / (1.0 + std::exp(-2.0 * steepness * sum)) - 1.0;
    });
  }
  return y;
}

}  // namespace prehend::learning
