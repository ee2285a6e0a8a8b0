#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "services/demonstration/core/segmentation/phase.hpp"

namespace prehend::demonstration {

/// A hand and the objects around it at a time.
struct SceneSample {
  double t = 0;          // s
  Eigen::Vector3d p_WG;  // where the hand grasps: the middle between its fingers, m
  double aperture = 0;   // m, between the thumb's tip and the others
  std::vector<std::optional<Eigen::Vector3d>> p_WO;  // of each object; none: it is not seen
};

/// What segmentation knows of hands, and of how noisy they are seen.
struct SegmenterOptions {
  double still_speed = 0.008;  // m/s, standard deviation of a hand that is still
  double still_rate = 0.004;   // m/s, of an aperture that stays
  double closing_rate = 0.15;  // m/s, about how fast fingers close and open
  double moving_speed = 0.5;   // m/s, about how fast a hand moves
  double near = 0.08;          // m, about how near the grasped object is
  double far = 0.3;            // m, about how near an object is otherwise
  double window = 0.2;         // s, over which speeds are taken
  /// s, that each phase lasts at least.
  std::array<double, phase_count> min_duration{0.25, 0.25, 0.12, 0.25, 0.12, 0.2};
  /// s, that each phase lasts at most.
  std::array<double, phase_count> max_duration{120, 6, 2.5, 120, 2.5, 6};
};

/// One phase; from the begin of its first sample to that of the next phase.
struct Segment {
  Phase phase{};
  double begin = 0, end = 0;          // s
  std::optional<std::size_t> object;  // of close, hold and release: which one
};

/// The phases of a demonstration. Samples in order of time, at an even rate as near as may be.
/// Fails on fewer than three samples, on times that do not rise, and on numbers that are not
/// finite.
Expected<std::vector<Segment>> segment(const std::vector<SceneSample>& samples,
                                       const SegmenterOptions& options);

}  // namespace prehend::demonstration
