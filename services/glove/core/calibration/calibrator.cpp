#include "services/glove/core/calibration/calibrator.hpp"

namespace prehend::glove {
namespace {

/// Nobody's hand is too big before it has been measured.
const ProcessorOptions any_hand{.hand = model::HumanHand(1.4)};

}  // namespace

Calibrator::Calibrator() : processor_(any_hand), still_(StillOptions{}) {}

std::optional<ShownPose> Calibrator::asked() const {
  if (shown_.size() >= shown_poses.size()) return std::nullopt;
  return shown_poses[shown_.size()];
}

std::optional<Shown> Calibrator::see(const Frame& frame) {
  const auto pose = asked();
  if (!pose) return std::nullopt;
  const auto wait = [&](std::string why) {
    waiting_for_ = std::move(why);
    return std::nullopt;
  };
  const Processed processed = processor_.process(frame, frame.stamp);
  if (!processed.posture)
    return wait("the hand is not seen: " +
                std::string(processed.rejects.empty() ? "" : processed.rejects.front()));
  std::vector<std::size_t> fingers;
  Eigen::VectorXd points(3 * model::finger_count);
  for (const Reading& reading : frame.readings) {
    const auto finger = finger_of(reading.site);
    if (!finger) continue;
    const auto f = static_cast<std::size_t>(*finger);
    const Fingertip& tip = processed.posture->fingertips[f];
    if (!tip.valid) return wait("a finger is not seen");
    points.segment<3>(3 * static_cast<Eigen::Index>(fingers.size())) = tip.p_HF;
    fingers.push_back(f);
    if (fingers.size() == model::finger_count) break;
  }
  if (fingers.size() < 3) return wait("the glove has sensors on fewer than three fingers");
  points.conservativeResize(3 * static_cast<Eigen::Index>(fingers.size()));
  const auto held = still_.see(frame.stamp, points);
  if (!held) return wait(std::string(still_.waiting_for()));

  Shown shown{*pose, {}, held->wobble};
  for (std::size_t i = 0; i < fingers.size(); ++i)
    shown.tips[fingers[i]] = {true, held->mean.segment<3>(3 * static_cast<Eigen::Index>(i))};
  if (const auto good = check_pose(*pose, shown.tips, shown_.empty() ? shown.tips : shown_[0].tips);
      !good)
    return wait(good.error().message());
  shown_.push_back(shown);
  waiting_for_.clear();
  return shown;
}

bool Calibrator::redo() {
  if (shown_.empty()) return false;
  shown_.pop_back();
  return true;
}

Expected<UserCalibration> Calibrator::result(const std::string& user) const {
  if (const auto pose = asked())
    return fail("the " + std::string(to_string(*pose)) + " was not shown", "calibration",
                waiting_for_);
  const auto fit = fit_hand({shown_[0].tips, shown_[1].tips, shown_[2].tips});
  if (!fit) return tl::unexpected(fit.error());
  UserCalibration result;
  result.user = user;
  result.scale = fit->scale;
  result.scale_sd = fit->scale_sd;
  result.residual = fit->residual;
  const model::HumanHand hand(fit->scale, fit->fingers);
  for (std::size_t f = 0; f < model::finger_count; ++f) {
    result.bones[f] = hand.bones(static_cast<model::Finger>(f));
    if (!shown_[0].tips[f].valid) continue;
    double near = shown_[0].tips[f].p_HF.norm(), far = near;
    for (const Shown& one : shown_) {
      near = std::min(near, one.tips[f].p_HF.norm());
      far = std::max(far, one.tips[f].p_HF.norm());
    }
    result.range[f] = {near, far};
  }
  return result;
}

}  // namespace prehend::glove
