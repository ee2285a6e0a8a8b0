#include "services/glove/core/calibration/joint_calibrator.hpp"

namespace prehend::glove {
namespace {

/// In counts: sensors tremble by one or two, and between two poses some finger bends by far more.
constexpr StillOptions still_in_counts{.still_within = 4, .apart = 25};

}  // namespace

JointCalibrator::JointCalibrator() : still_(still_in_counts) {}

std::optional<ShownPose> JointCalibrator::asked() const {
  if (shown_.size() >= shown_poses.size()) return std::nullopt;
  return shown_poses[shown_.size()];
}

std::optional<Shown> JointCalibrator::see(const Frame& frame) {
  const auto pose = asked();
  if (!pose) return std::nullopt;
  const auto count = static_cast<Eigen::Index>(frame.joint_counts.size());
  if (joint_sensors_of(frame.joint_counts.size()).empty()) {
    waiting_for_ = "the glove sends no joints";
    return std::nullopt;
  }
  // Three sensors at a time are a point to the taker.
  Eigen::VectorXd points = Eigen::VectorXd::Zero((count + 2) / 3 * 3);
  points.head(count) = Eigen::Map<const Eigen::VectorXd>(frame.joint_counts.data(), count);
  const auto held = still_.see(frame.stamp, points);
  if (!held) {
    waiting_for_ = still_.waiting_for();
    return std::nullopt;
  }
  shown_.emplace_back(held->mean.data(), held->mean.data() + count);
  waiting_for_.clear();
  return Shown{*pose, {}, held->wobble};
}

bool JointCalibrator::redo() {
  if (shown_.empty()) return false;
  shown_.pop_back();
  return true;
}

Expected<JointGains> JointCalibrator::result() const {
  if (const auto pose = asked())
    return fail("the " + std::string(to_string(*pose)) + " was not shown", "calibration",
                waiting_for_);
  return fit_gains({shown_[0]}, {shown_[1]}, {shown_[2]});
}

}  // namespace prehend::glove
