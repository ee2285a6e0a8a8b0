#pragma once

#include <Eigen/Core>
#include <optional>
#include <string_view>

#include "common/base/pose.hpp"
#include "common/model/shape.hpp"

namespace prehend::mapping {

/// What an intelligent network is told of the object beside the hand's features.
enum class SizeInput {
  characteristic,  // one number, as in [Thesis, 5.3]: radius, or a box's depth
  dimensions,      // all that describe the shape: radius, height; depth, length, height
  seen             // as the hand meets it: width across the closing fingers, depth along the
                   // approach, length along the third axis, and how far the palm comes from above
};

std::string_view to_string(SizeInput input);
std::optional<SizeInput> size_input_from_string(std::string_view name);

/// The numbers for a network of this shape, a cone's of the cylinder that it is like: lengths in m,
/// the direction as the downward part of the approach, 0 to 1. X_OG: the grasp frame that the hand
/// is at or reaches for, as model::nearest_grasp gives it; only `seen` depends on it.
Eigen::VectorXd size_numbers(SizeInput input, const model::Shape& seen, const Pose& X_OG);

/// How many these are.
int size_count(SizeInput input, model::ShapeKind shape);

}  // namespace prehend::mapping
