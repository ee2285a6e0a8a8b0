#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/error.hpp"

namespace prehend::learning {

/// Weights into the neurons of one layer, a row a neuron; the last column is the bias.
using Layer = Eigen::MatrixXd;

/// What a layer sees.
enum class Wiring {
  layered,  // the layer before it
  shortcut  // the inputs and all layers before it, in that order: what cascade training grows
};

/// A fully connected feed-forward network with a symmetric sigmoid in every layer:
/// y = tanh(s · (W x + b)), s = 0.5 as in FANN. It is a value: evaluating it from several threads
/// is safe, and neither locale nor file format of the library that trained it matters.
class Network {
 public:
  /// Refuses no layers, empty ones, ones that do not fit each other, and weights that are not
  /// finite.
  static Expected<Network> create(std::vector<Layer> layers, Wiring wiring = Wiring::layered);

  int inputs() const { return static_cast<int>(layers_.front().cols()) - 1; }
  int outputs() const { return static_cast<int>(layers_.back().rows()); }
  /// Neurons in all layers but the last.
  int hidden() const;
  const std::vector<Layer>& layers() const { return layers_; }
  Wiring wiring() const { return wiring_; }

  /// x: inputs() numbers, scaled. Returns outputs() numbers in (-1, 1).
  Eigen::VectorXd evaluate(const Eigen::VectorXd& x) const;

 private:
  Network(std::vector<Layer> layers, Wiring wiring) : layers_(std::move(layers)), wiring_(wiring) {}
  std::vector<Layer> layers_;
  Wiring wiring_;
};

}  // namespace prehend::learning
