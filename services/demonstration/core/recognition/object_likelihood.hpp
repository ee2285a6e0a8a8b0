#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/shape.hpp"
#include "services/demonstration/core/recognition/hand_sample.hpp"

namespace prehend::demonstration {

/// P(shape and size | kind of grasp), learnt from takes whose object was measured: how often a kind
/// goes with such a shape, and how large such objects are (logarithms of sizes are normal). What a
/// recogniser answers is multiplied by it. A value.
class ObjectLikelihood {
 public:
  /// classes: in whose order answers are. Fails when no take has an object.
  static Expected<ObjectLikelihood> learn(const std::vector<const Take*>& takes,
                                          const std::vector<std::string>& classes);

  /// Of each class, but for a common factor; above 0.
  Eigen::VectorXd of(const model::Shape& object) const;

 private:
  /// One kind of grasp with one kind of shape.
  struct Sizes {
    double share = 0;                  // of the kind's takes
    Eigen::VectorXd means, variances;  // of the sizes' logarithms; empty: too few takes to say
  };

  std::map<std::pair<std::size_t, model::ShapeKind>, Sizes> sizes_;  // by class and shape
  std::vector<double> otherwise_;  // share of a shape that was never seen with a class
};

}  // namespace prehend::demonstration
