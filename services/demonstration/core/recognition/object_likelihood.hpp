#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/shape.hpp"
#include "services/demonstration/core/recognition/hand_sample.hpp"
#include "services/demonstration/core/recognition/whitening.hpp"

namespace prehend::demonstration {

/// What is looked at beside an object's shape and size.
enum class Beside {
  nothing,  // P(object | kind): which kinds go with such objects at all
  hand      // P(object | kind, hand): and how large an object is about which a hand closes so far
};

/// How well each kind of grasp explains the object that is grasped, learnt from takes whose object
/// was measured. Logarithms of sizes are normal, about a mean that is linear in the distances
/// between fingertips (or constant). A value.
class ObjectLikelihood {
 public:
  /// classes: in whose order answers are. Fails when no take has an object.
  static Expected<ObjectLikelihood> learn(const std::vector<const Take*>& takes,
                                          const std::vector<std::string>& classes, Beside beside);

  /// Of each class, but for a common factor; above 0. hand: the grasp's last sample.
  Eigen::VectorXd of(const model::Shape& object, const HandSample& hand) const;

 private:
  /// One kind of grasp with one kind of shape.
  struct Sizes {
    double share = 0;              // of the kind's takes
    Eigen::MatrixXd coefficients;  // a column a size; empty: too few takes to say
    Eigen::MatrixXd uncertainty;   // of the coefficients, for a variance of 1
    Eigen::VectorXd variances;     // of the sizes' logarithms about the mean
  };
  Eigen::VectorXd regressors(const HandSample& hand) const;
  static Sizes sizes_of(const Eigen::MatrixXd& regressors, const Eigen::MatrixXd& sizes);

  Beside beside_ = Beside::nothing;
  std::optional<Whitening> scale_;
  std::map<std::pair<std::size_t, model::ShapeKind>, Sizes> sizes_;  // by class and shape
  std::vector<double> otherwise_;  // share of a shape that was never seen with a class
};

}  // namespace prehend::demonstration
