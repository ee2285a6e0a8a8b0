#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/shape.hpp"
#include "services/demonstration/core/recognition/hand_sample.hpp"

namespace prehend::demonstration {

/// P(shape and size | kind of grasp), learnt from takes whose object was measured: how often a kind
/// goes with such a shape, and how large such objects are: each that was shown stands for those of
/// nearly its size. What a recogniser answers is multiplied by it. A value.
class ObjectLikelihood {
 public:
  /// One kind of grasp with one kind of shape.
  struct Sizes {
    std::size_t kind = 0;  // index of its class
    model::ShapeKind shape{};
    double share = 0;       // of the kind's takes
    Eigen::MatrixXd shown;  // logarithms of sizes, a column an object; none: too few takes to say
    Eigen::VectorXd reach;  // logarithm: how far each of them speaks for others; made by create()
  };

  /// classes: in whose order answers are. Fails when no take has an object.
  static Expected<ObjectLikelihood> learn(const std::vector<const Take*>& takes,
                                          const std::vector<std::string>& classes);

  /// From stored numbers. otherwise: of each class, the share of a shape never seen with it.
  /// Refuses what is not finite, shares that are not above 0, and sizes that do not fit their
  /// shape.
  static Expected<ObjectLikelihood> create(std::vector<Sizes> sizes, std::vector<double> otherwise);

  /// Of each class, but for a common factor; above 0.
  Eigen::VectorXd of(const model::Shape& seen) const;

  const std::vector<Sizes>& sizes() const { return sizes_; }
  const std::vector<double>& otherwise() const { return otherwise_; }

 private:
  std::vector<Sizes> sizes_;
  std::vector<double> otherwise_;
};

}  // namespace prehend::demonstration
