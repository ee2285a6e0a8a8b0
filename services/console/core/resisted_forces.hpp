#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/analysis/contact.hpp"

namespace prehend::console {

/// The forces at the object's middle, without a moment, that contacts can resist while their normal
/// forces add up to 1 N: a slice of the wrench hull, in the object's frame, N. Three corners a
/// triangle, outside counterclockwise. Nothing where some direction is not resisted at all. Of more
/// than eight contacts the eight that are spread most widely count, so that a report costs a few
/// milliseconds. Pure.
std::vector<Eigen::Vector3d> resisted_forces(const std::vector<analysis::Contact>& contacts);

}  // namespace prehend::console
