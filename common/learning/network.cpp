#include "common/learning/network.hpp"

#include <fmt/format.h>

#include <cmath>

namespace prehend::learning {

namespace {

constexpr double steepness = 0.5;

/// What a layer answers to the numbers it sees.
Eigen::VectorXd answer(const Layer& layer, const auto& seen) {
  const auto n = layer.cols() - 1;
  // Written as FANN writes it, so that training and use agree to the last bits.
  return (layer.leftCols(n) * seen + layer.col(n)).eval().unaryExpr([](double sum) {
    return 2.0 / (1.0 + std::exp(-2.0 * steepness * sum)) - 1.0;
  });
}

}  // namespace

Expected<Network> Network::create(std::vector<Layer> layers, Wiring wiring) {
  if (layers.empty()) return fail("a network has no layers");
  Eigen::Index seen = layers.front().cols() - 1;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const Layer& layer = layers[i];
    if (layer.rows() < 1 || layer.cols() < 2) return fail(fmt::format("layer {} is empty", i));
    if (layer.cols() != seen + 1)
      return fail(fmt::format("layer {} takes {} numbers and gets {}", i, layer.cols() - 1, seen));
    if (!layer.allFinite()) return fail(fmt::format("layer {} has weights that are not finite", i));
    seen = wiring == Wiring::shortcut ? seen + layer.rows() : layer.rows();
  }
  return Network(std::move(layers), wiring);
}

int Network::hidden() const {
  Eigen::Index count = -layers_.back().rows();
  for (const Layer& layer : layers_) count += layer.rows();
  return static_cast<int>(count);
}

Eigen::VectorXd Network::evaluate(const Eigen::VectorXd& x) const {
  if (wiring_ == Wiring::layered) {
    Eigen::VectorXd y = x;
    for (const Layer& layer : layers_) y = answer(layer, y);
    return y;
  }
  Eigen::VectorXd seen(x.size() + hidden() + outputs());
  seen.head(x.size()) = x;
  auto count = x.size();
  for (const Layer& layer : layers_) {
    seen.segment(count, layer.rows()) = answer(layer, seen.head(count));
    count += layer.rows();
  }
  return seen.tail(outputs());
}

}  // namespace prehend::learning
