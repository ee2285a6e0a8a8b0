#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"

namespace prehend::glove {

struct Registration {
  Pose X_WT = Pose::Identity();
  double residual = 0;  // m, RMS of the points' distances
  double worst = 0;     // m, of one point
};

/// The rigid motion that brings points touched, in T, to where they are known to be, in W, with the
/// least sum of squares (Kabsch 1976, Umeyama 1991 without scale). Fails with fewer than three
/// points, with points nearly on one line (their spread across it under 3 cm), and where the two
/// sets are not the same figure (some point more than 3 cm off).
Expected<Registration> register_tracker(const std::vector<Eigen::Vector3d>& p_W,
                                        const std::vector<Eigen::Vector3d>& p_T);

/// The seven numbers of tracker.X_WT as lab.toml has them.
std::string x_wt_line(const Pose& X_WT);

}  // namespace prehend::glove
