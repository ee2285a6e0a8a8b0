#include "services/simulation/service/arm_teller.hpp"

#include <fmt/format.h>

#include <utility>

#include "common/arm/mounting.hpp"
#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "common/model/arm_choice.hpp"

namespace prehend::simulation {
namespace {

constexpr Duration patience = std::chrono::milliseconds(300);  // with what hinders the arm
constexpr double max_bracket = 1.2;                            // rad

Expected<Pose> pose_from(const service::Config& config, std::string_view key) {
  const std::vector<double>& n = config.numbers(key);
  const char* hint = "x, y, z in m, then the quaternion w, x, y, z";
  if (n.size() != 7) return wrong_use("needs seven numbers", std::string(key), hint);
  auto X = checked_pose({n[0], n[1], n[2]}, {n[3], n[4], n[5], n[6]});
  if (!X) return wrong_use(X.error().what, std::string(key), hint);
  return *X;
}

v1::ArmHindrance to_message(arm::Hindrance hindrance) {
  switch (hindrance) {
    case arm::Hindrance::none:
      return v1::HINDRANCE_NONE;
    case arm::Hindrance::on_the_way:
      return v1::HINDRANCE_ON_THE_WAY;
    case arm::Hindrance::joint_limit:
      return v1::HINDRANCE_JOINT_LIMIT;
    case arm::Hindrance::collision:
      return v1::HINDRANCE_COLLISION;
    case arm::Hindrance::reach:
      return v1::HINDRANCE_REACH;
    default:
      return v1::HINDRANCE_NO_WISH;
  }
}

std::vector<double> to_message(const arm::Joints& q) {
  return {q.begin(), q.end()};
}

/// Why the hand is not where it shall be; empty where that needs no words.
std::string trouble_of(const carrying::ArmMotion& motion, const model::ArmModel& arm) {
  if (motion.too_heavy)
    return fmt::format("{} does not lift what weighs {:.1f} kg with the hand; its payload is {} kg",
                       arm.name, motion.carried, arm.payload);
  const auto because = [&](const char* why) {
    return fmt::format("{} is {:.0f} mm from where the hand shall be: {}", arm.name,
                       1000 * motion.off_m, why);
  };
  switch (motion.hindrance) {
    case arm::Hindrance::joint_limit:
      return because("a joint is at its end");
    case arm::Hindrance::collision:
      return because("something is in the way");
    case arm::Hindrance::reach:
      return because("it is out of reach");
    default:
      return {};
  }
}

}  // namespace

Expected<std::unique_ptr<carrying::CarryingArm>> arm_of(const service::Config& config,
                                                        const model::HandModel& hand) {
  const std::string& name = config.text("robot.arm");
  if (name.empty()) return nullptr;
  auto arm = model::load_arm(name);
  if (!arm) {
    arm.error().exit = exit_wrong_use;
    return tl::unexpected(arm.error());
  }
  const auto X_WA = pose_from(config, "robot.X_WA");
  if (!X_WA) return tl::unexpected(X_WA.error());
  const double bracket = config.number("robot.bracket");
  if (!(bracket >= 0 && bracket <= max_bracket))
    return wrong_use("must be 0 to 1.2", "robot.bracket");
  Expected<Pose> X_EB = arm->X_EF * arm::mounted(hand, bracket);
  if (!config.numbers("robot.X_EB").empty()) X_EB = pose_from(config, "robot.X_EB");
  if (!X_EB) return tl::unexpected(X_EB.error());
  return carrying::CarryingArm::create(std::move(*arm), hand, *X_WA, *X_EB);
}

ArmTeller::ArmTeller(service::Shell& shell, const carrying::CarryingArm& arm)
    : shell_(shell),
      arm_(arm),
      commands_(shell.publish(dds::arm_command)),
      states_(shell.publish(dds::arm_state)) {
  const std::string& name = shell.config().text("robot.arm_name");
  command_.arm(name);
  command_.model(arm.model().name);
  state_.arm(name);
  state_.model(arm.model().name);
  state_.X_WA(convert::to_message(arm.X_WA()));
}

void ArmTeller::tell(const carrying::ArmMotion& motion, const std::optional<Command>& command,
                     Time now) {
  const std::int64_t origin = command ? to_ns(command->origin) : 0;
  command_.stamp_ns(to_ns(now));
  command_.origin_ns(origin);
  command_.joint(to_message(motion.told));
  command_.velocity(to_message(motion.told_velocity));
  commands_.publish(command_);
  command_.sequence_number(command_.sequence_number() + 1);

  const arm::Joints velocity = joint_ && now > told_
                                   ? arm::Joints((motion.joint - *joint_) / to_seconds(now - told_))
                                   : motion.told_velocity;
  joint_ = motion.joint;
  told_ = now;
  state_.stamp_ns(to_ns(now));
  state_.origin_ns(origin);
  state_.joint(to_message(motion.joint));
  state_.velocity(to_message(velocity));
  state_.torque(to_message(motion.torque));
  state_.X_WB(convert::to_message(motion.X_WB));
  state_.off_m(motion.off_m);
  state_.off_rad(motion.off_rad);
  state_.hindrance(to_message(motion.hindrance));
  states_.publish(state_);
  state_.sequence_number(state_.sequence_number() + 1);
  complain(motion, now);
}

/// Only of what lasts.
void ArmTeller::complain(const carrying::ArmMotion& motion, Time now) {
  const std::string trouble = trouble_of(motion, arm_.model());
  if (is_troubled_ == trouble.empty()) since_ = now;
  is_troubled_ = !trouble.empty();
  if (is_troubled_ && now - since_ < patience) return;
  if (trouble.empty() && !said_) return;
  said_ = !trouble.empty();
  shell_.status().note(trouble);
}

}  // namespace prehend::simulation
