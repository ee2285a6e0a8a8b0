#pragma once

#include <vector>

#include "common/learning/network.hpp"
#include "common/learning/training.hpp"

namespace prehend::learning {

/// RPROP (iRPROP−: Igel and Hüsken, 2000) for a layered network, over all samples at once. The same
/// as FANN's to rounding, its error function (inverse of the hyperbolic tangent) included, but
/// computed in matrices, which takes a fraction of the time. Keeps a reference to the samples.
class Rprop {
 public:
  /// layers: the first weights; they must fit the samples.
  Rprop(std::vector<Layer> layers, const Samples& samples);

  /// One step of all weights.
  void epoch();
  const std::vector<Layer>& layers() const { return layers_; }

 private:
  /// Adds what these samples say to the slopes of all weights.
  void learn(Eigen::Index begin, Eigen::Index count);

  std::vector<Layer> layers_;
  Eigen::MatrixXd inputs_, wanted_;    // a column a sample; the last row of the inputs is 1
  std::vector<Layer> slopes_;          // of the weights
  std::vector<Layer> steps_, before_;  // in the epoch before, the latter slopes
};

}  // namespace prehend::learning
