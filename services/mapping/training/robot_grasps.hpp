#pragma once

#include <prehend/base/error.hpp>
#include <prehend/model/catalogue.hpp>
#include <prehend/model/hand_model.hpp>
#include <string>
#include <vector>

#include "scheme.hpp"

namespace prehend::mapping {

/// A robot hand closed on an object.
struct RobotGrasp {
  std::string object;
  std::string type;  // power wrap, circular sphere, precision
  model::Shape shape;
  Pose X_OG;            // grasp frame that was closed from
  Eigen::VectorXd dof;  // rad: where the fingers were stopped
  double epsilon = -1;
  bool held = false;  // after being lifted
};

/// Places a hand's grasp frame everywhere where the object can be grasped in another way: from
/// above and from the side, across each pair of faces.
std::vector<Pose> approaches(const model::Shape& shape, const model::Reach& reach);

/// Closes the hand in Bullet from every preshape of the scheme, and keeps the one that holds when
/// it is lifted, with the largest epsilon. Fails when the fingers find no two contacts from any.
Expected<RobotGrasp> robot_grasp(const model::HandModel& hand, const Scheme& scheme,
                                 const model::CatalogueObject& object, const Pose& X_OG);

}  // namespace prehend::mapping
