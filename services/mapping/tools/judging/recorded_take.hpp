#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "services/mapping/core/mapping.hpp"
#include "services/mapping/tools/training/demonstrator.hpp"
#include "services/mapping/tools/training/robot_grasps.hpp"

namespace prehend::mapping {

/// How a person reaches for an object, and how the camera errs about it.
struct TakeOptions {
  DemonstratorOptions demonstrator;  // how people and their sensors differ
  /// A hand at rest gets ready while it reaches, as people's do; late: not before it closes.
  bool late = false;
  double size_error = 0;       // the object is seen larger or smaller by this share of its size
  double position_error = 0;   // m, sigma of each horizontal coordinate at which it is seen
  double angle_error = 0;      // rad, sigma of its turn
  double claimed_error = 0;    // m, the same as told, if that is more: a camera that is careful
  bool says_uncertain = true;  // detections carry these errors as their covariance
};

inline constexpr double glove_rate = 30;         // Hz
inline constexpr double reach_time = 1.6 + 0.2;  // s, until fingers begin to close
inline constexpr double keep_time = 4;           // s, with closed fingers, at most

/// One reach for one object as glove and camera tell it, whatever robot hand shall answer it: from
/// 25 cm before the grasp to closed fingers that keep closed. W: the table; the object stands on it
/// above the origin.
struct RecordedTake {
  std::string user;
  Pose X_WO;                      // of the object, as it is before anything touches it
  Pose X_WG;                      // of the human grasp frame when it has arrived
  Closure closure;                // of the human fingers when they have closed
  Time closed;                    // when that is
  std::vector<Posture> postures;  // at 30 Hz, from time 0
  model::Shape seen_shape;
  Pose X_OS;                   // where the object is seen from where it is
  Eigen::Matrix4d covariance;  // as told
};

/// Where the hand is in the frame in which it will have arrived: 25 cm before it at time 0, s.
Pose approach_at(double t);

/// How the camera sees this shape in the take; its errors follow from the seed.
void see_object(RecordedTake& take, const model::Shape& shape, std::uint64_t seed,
                const TakeOptions& options);

/// The take of a person who follows from the seed, with the grasp that the robot hand was closed
/// in: the same seed gives the same person and the same take. None when this person's hand does not
/// fit around the object from there.
std::optional<RecordedTake> record_take(const RobotGrasp& grasp, std::uint64_t seed,
                                        const TakeOptions& options);

}  // namespace prehend::mapping
