#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::grasping {

/// Two links of different fingers that touch, or the first of which runs into the second when its
/// finger opens.
struct LinkPair {
  int link = 0, other = 0;

  bool operator==(const LinkPair&) const = default;
};

/// Which fingers stand in each other's way. Fingers are the hand's fingertips, by number.
struct Blocking {
  std::vector<LinkPair> touching;  // now, within 1 mm
  std::vector<LinkPair> blocked;   // link cannot open while the other stays where it is
  /// An order in which the fingers open one after the other; none when they are interlocked.
  std::optional<std::vector<int>> order;
};

/// Moves each finger, in thought, from the given joint values to the posture "open" along a
/// straight line in joint space, its closing DoFs only, while the others stay closed or are open
/// already. Objects play no part. Deterministic; up to half a second for five fingers. Fails on
/// joint values of the wrong number or not finite.
Expected<Blocking> find_blocking(const model::HandModel& hand, const Eigen::VectorXd& joint);

/// What to tell a person, in one line; empty when nothing blocks.
std::string to_string(const Blocking& blocking, const model::HandModel& hand);

}  // namespace prehend::grasping
