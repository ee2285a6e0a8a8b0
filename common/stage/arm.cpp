#include "common/stage/arm.hpp"

#include <algorithm>
#include <cmath>

#include "common/arm/mounting.hpp"
#include "common/model/arm_choice.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::stage {

Expected<std::optional<model::ArmModel>> carrying_arm(const service::Config& config) {
  const std::string& name = config.text("robot.arm");
  if (name.empty()) return std::nullopt;
  auto arm = model::load_arm(name);
  if (!arm) return tl::unexpected(arm.error());
  const auto hand = model::HandModel::load(model::hand_directory(config.text("simulation.hand")));
  if (!hand) return tl::unexpected(hand.error());
  if (const auto fits = arm::check_fit(*arm, *hand); !fits) return tl::unexpected(fits.error());
  return std::optional(std::move(*arm));
}

ArmUse::ArmUse(const model::ArmModel& arm) : name_(arm.name) {
  for (const model::ArmJoint& joint : arm.joints) speeds_.push_back(joint.velocity);
}

void ArmUse::hear(const v1::ArmState& state) {
  for (std::size_t i = 0; i < std::min(speeds_.size(), state.velocity().size()); ++i)
    worst_ = std::max(worst_, std::abs(state.velocity()[i]) / speeds_[i]);
  ++states_;
  const v1::ArmHindrance why = state.hindrance();
  hindered_ += why == v1::HINDRANCE_JOINT_LIMIT || why == v1::HINDRANCE_COLLISION ||
               why == v1::HINDRANCE_REACH;
}

double ArmUse::out_of_reach() const {
  return states_ == 0 ? 0 : static_cast<double>(hindered_) / static_cast<double>(states_);
}

}  // namespace prehend::stage
