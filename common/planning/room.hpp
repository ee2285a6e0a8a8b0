#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/planning/scene.hpp"

namespace prehend::planning {

struct RoomOptions {
  double clearance = 0.01;       // m, of the arm from itself and all else
  double hand_clearance = 0.01;  // m, of the hand and what it holds
  std::string touched = {};      // an obstacle that hand and held object may touch, not the arm
  double joint_margin = 0;       // rad, of each joint from its limits
  /// Least singular value of the arm's Jacobian, a radian counted as 0.15 m. An arm that stays
  /// above it never changes its branch, so that who follows its hand follows its joints.
  double min_dexterity = 0.01;
};

/// Two parts that are too near to each other.
struct Conflict {
  std::string first, second;
  double distance = 0;  // m, negative where they overlap

  std::string message() const;  // «link4 is 3 mm from Cup»
};

/// Where an arm with a hand, and with what that holds, has room in a scene. Capsules of the arm,
/// shapes of the hand and solids meet in Bullet; arm, table and the hand's base as in
/// arm::Collision. Fingers are not tested against the links that carry the hand. Keeps the robot's
/// models; not thread-safe.
class Room {
 public:
  Room(const Robot& robot, const Scene& scene, const RoomOptions& options = {});
  ~Room();
  Room(Room&&) noexcept;
  Room& operator=(Room&&) noexcept;

  /// What was too near in this posture may be as near from now on: an arm that has let go of
  /// something stands close to it. So with the margin of joints, and dexterity.
  void tolerate(const arm::Joints& start);

  /// The first conflict that is found, if any.
  std::optional<Conflict> conflict(const arm::Joints& q) const;
  /// Within the limits of the joints, dexterous enough, and without a conflict.
  bool is_free(const arm::Joints& q) const;
  /// The same all the way, straight in the joints: looks so often that nothing moves by more than
  /// the lesser clearance in between.
  bool is_free(const arm::Joints& from, const arm::Joints& to) const;
  /// Why it is not free; empty if it is.
  std::string trouble(const arm::Joints& q) const;

  /// Upper bound of how far anything moves with the joints, m.
  double swept(const arm::Joints& from, const arm::Joints& to) const;
  /// The smallest singular value, see RoomOptions.
  double dexterity(const arm::Joints& q) const;

 private:
  std::optional<std::size_t> joint_at_limit(const arm::Joints& q) const;

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace prehend::planning
