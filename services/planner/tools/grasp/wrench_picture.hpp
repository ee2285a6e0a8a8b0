#pragma once

#include <Eigen/Core>
#include <filesystem>

#include "common/analysis/resistance.hpp"
#include "common/base/error.hpp"

namespace prehend::planner {

/// Two 3-D projections of a 6-D wrench space side by side as PNG: forces and torques, each the hull
/// of the projected wrenches with the origin and the part of the hardest load that shows in it. A
/// flat projection is drawn as its points. wrenches: six finite numbers a column. Fails when
/// gnuplot is missing or cannot write.
Expected<void> draw_wrench_space(const Eigen::MatrixXd& wrenches,
                                 const analysis::Resistance& resistance,
                                 const std::filesystem::path& png);

}  // namespace prehend::planner
