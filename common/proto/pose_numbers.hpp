#pragma once

#include <array>
#include <vector>

#include "common/base/pose.hpp"

namespace prehend::proto {

/// A pose as it lies in our files: the rows of the 3 by 4 matrix (R | p), p in m. Unlike a
/// quaternion it comes back bit for bit.
std::array<double, 12> pose_numbers(const Pose& X);
/// Refuses another count, what is not finite and what is no rotation.
Expected<Pose> pose_from_numbers(const std::vector<double>& numbers);

}  // namespace prehend::proto
