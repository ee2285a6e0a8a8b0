#include "common/grasping/closing.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::grasping {
namespace {

using Eigen::VectorXd;

constexpr double lead = 1.0 / 3;     // share of the squeeze, and so of the torque, while closing
constexpr double stands_for = 0.15;  // s, that hand and object stand still, on average slower than
constexpr double still = 0.02;       // rad/s, of every joint
constexpr double object_still = 0.002;  // m/s
constexpr double object_turns = 0.05;   // rad/s
constexpr double overlap = 0.001;       // m, that a preshape may already press into the object
constexpr double damping = 20;          // 1/s, of an object that floats while it is grasped

/// Tells when hand and object have kept their place for a while. Positions are looked at, since
/// joints that are pressed against their limits or each other report speeds without moving.
class Rest {
 public:
  explicit Rest(const World& world) { restart(world); }

  /// True if nothing has moved on since `stands_for` before; to be asked after each step.
  bool reached(const World& world) {
    since_ += world.time_step();
    if (moved(world)) restart(world);
    return since_ > stands_for;
  }

 private:
  bool moved(const World& world) const {
    const VectorXd joint = world.hand_motion().joint;
    for (Eigen::Index i = 0; i < joint.size(); ++i) {
      const auto& driven = world.hand().joints()[static_cast<std::size_t>(i)];
      const auto& dof = world.hand().dofs()[static_cast<std::size_t>(driven.dof)];
      if (!(std::abs(joint[i] - joint_[i]) < still * stands_for * radian_of(dof))) return true;
    }
    const Pose X_WO = world.body_motion(0).X_WO;
    return !((X_WO.translation() - X_WO_.translation()).norm() < object_still * stands_for) ||
           !(angle_between(X_WO.linear(), X_WO_.linear()) < object_turns * stands_for);
  }

  void restart(const World& world) {
    joint_ = world.hand_motion().joint;
    X_WO_ = world.body_motion(0).X_WO;
    since_ = 0;
  }

  VectorXd joint_;
  Pose X_WO_;
  double since_ = 0;  // s
};

/// Which way a DoF closes the hand, 0 if it rests.
int closing_of(const model::HandModel& hand, const ClosingOptions& options, Eigen::Index i) {
  const auto k = static_cast<std::size_t>(i);
  return k < options.resting.size() && options.resting[k] ? 0 : hand.dofs()[k].closing;
}

/// Commands every closing DoF ahead of its joint until all have stopped. False if they never do.
bool close_until_still(World& world, const ClosingOptions& options) {
  const model::HandModel& hand = world.hand();
  const Pose X_WB = world.commanded_base();
  VectorXd command = world.commanded_dof();
  const double dt = world.time_step();
  Rest rest(world);
  for (double t = 0; t < options.longest; t += dt) {
    const VectorXd now = world.hand_motion().dof;
    for (Eigen::Index i = 0; i < command.size(); ++i) {
      const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(i)];
      const int closing = closing_of(hand, options, i);
      if (closing == 0) continue;
      const double next = command[i] + closing * options.speed * radian_of(dof) * dt;
      const double most = now[i] + closing * lead * dof.squeeze;
      command[i] = closing > 0 ? std::min(next, most) : std::max(next, most);
    }
    world.command(X_WB, hand.clamp(command));
    world.step();
    // The drives need a moment before they move at all.
    if (rest.reached(world) && t > 0.1 + stands_for) return true;
  }
  return false;
}

Expected<analysis::Quality> judge(const std::vector<analysis::Contact>& contacts,
                                  const Body& object, bool volume) {
  if (volume)
    return analysis::grasp_quality(about_centre_of_mass(contacts, object), torque_scale(object));
  auto resistance = analysis::l1_resistance(analysis::contact_wrenches(
      analysis::spread_contacts(about_centre_of_mass(contacts, object), analysis::max_contacts),
      torque_scale(object)));
  if (!resistance) return tl::unexpected(resistance.error());
  return analysis::Quality{std::move(*resistance)};
}

HoldResult squeeze_and_hold(World& world, const VectorXd& contact, const ClosingOptions& options) {
  const model::HandModel& hand = world.hand();
  VectorXd squeezed = contact;
  for (Eigen::Index i = 0; i < squeezed.size(); ++i) {
    const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(i)];
    squeezed[i] += options.squeeze * dof.squeeze * closing_of(hand, options, i);
  }
  world.command(world.commanded_base(), hand.clamp(squeezed));
  const double dt = world.time_step();
  for (double t = 0; t < 0.5; t += dt) world.step();
  world.set_object_damping(0);
  world.set_gravity(9.81 * options.down_B.normalized());
  return hold_test(world, 0, *options.hold_test);
}

}  // namespace

bool fingers_move_as_one(const model::HandModel& hand) {
  const auto finger_of = [&](const model::HandJoint& joint) {
    return hand.links()[static_cast<std::size_t>(joint.child)].finger;
  };
  return std::any_of(
      hand.joints().begin(), hand.joints().end(), [&](const model::HandJoint& joint) {
        if (joint.geared_to < 0 || finger_of(joint) < 0) return false;
        const int other = finger_of(hand.joints()[static_cast<std::size_t>(joint.geared_to)]);
        return other >= 0 && other != finger_of(joint);
      });
}

Expected<ClosedGrasp> close_hand(const model::HandModel& hand, const Body& object, const Pose& X_BO,
                                 const Eigen::VectorXd& preshape, const ClosingOptions& options) {
  if (!(options.longest > 0) || !(options.speed > 0) || !(options.squeeze >= 0))
    return fail("time and speed must be positive, the squeeze 0 or more", "closing");
  if (!options.down_B.allFinite() || options.down_B.norm() < 1e-9)
    return fail("down needs a direction", "closing");
  WorldOptions world_options;
  world_options.table = false;
  world_options.iterations = 100;  // many fingers, as of the human hand, hold better for it
  world_options.gravity_W.setZero();
  world_options.object_damping = damping;
  auto created = World::create(hand, Pose::Identity(), preshape, world_options);
  if (!created) return tl::unexpected(created.error());
  std::unique_ptr<World> world = std::move(*created);
  Body body = object;
  if (options.fixed_object) body.mass = 0;
  if (auto added = world->add_body(body, X_BO); !added) return tl::unexpected(added.error());
  if (world->distance_to_hand(0, 0.01) < -overlap)
    return fail("the hand is inside the object before it closes", object.name,
                "open the preshape or stand further off");

  if (!close_until_still(*world, options))
    return fail("the fingers did not come to rest", object.name);
  ClosedGrasp grasp;
  const HandMotion motion = world->hand_motion();
  grasp.dof = motion.dof;
  grasp.joints = motion.joint;
  grasp.X_BO = motion.X_WB.inverse() * world->body_motion(0).X_WO;
  grasp.contacts = world->contacts(0);
  if (grasp.contacts.size() < 2)
    return fail("fewer than two contacts", object.name, "the object is out of the fingers' reach");
  auto quality = judge(grasp.contacts, object, options.volume);
  if (!quality) return tl::unexpected(quality.error());
  grasp.quality = std::move(*quality);
  if (options.hold_test) {
    if (options.fixed_object || !(object.mass > 0)) {
      // The fixed object served to find the posture; a free one in its place is lifted.
      auto lifted = World::create(hand, Pose::Identity(), grasp.dof, world_options);
      if (!lifted) return tl::unexpected(lifted.error());
      if (auto added = (*lifted)->add_body(object, grasp.X_BO); !added)
        return tl::unexpected(added.error());
      grasp.hold = squeeze_and_hold(**lifted, grasp.dof, options);
    } else {
      grasp.hold = squeeze_and_hold(*world, grasp.dof, options);
    }
  }
  return grasp;
}

}  // namespace prehend::grasping
