#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/model/shape.hpp"

namespace prehend::mapping {

/// Where a robot hand stood when it grasped an object well: its fingers do not meet in the same
/// place around what is thin and what is thick.
struct PalmOffset {
  model::ShapeKind shape = model::ShapeKind::unknown;
  Eigen::Vector4d seen = Eigen::Vector4d::Zero();  // of the object: see SizeInput::seen
  Eigen::Vector3d p_GR = Eigen::Vector3d::Zero();  // m, of its grasp frame R in the grasp asked for
};

/// Fails on what is no shape, not finite, or more than 10 cm off.
Expected<void> check(const PalmOffset& learnt);

/// Where it should stand for this object, with the grasp frame X_OG asked for: the mean of what was
/// learnt of this shape, those of the most alike size counting most (Shepard's weights). Zero if
/// nothing was learnt of it.
Eigen::Vector3d place_for(const std::vector<PalmOffset>& learnt, const model::Shape& shape,
                          const Pose& X_OG);

}  // namespace prehend::mapping
