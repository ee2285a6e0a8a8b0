#include "services/glove/devices/worn_joints.hpp"

#include <utility>

#include "common/base/log.hpp"
#include "services/glove/devices/nest_of_birds.hpp"

namespace prehend::glove {
namespace {

using Clock = std::chrono::steady_clock;

constexpr Duration wrist_memory = std::chrono::milliseconds(150);  // for which its last pose holds

}  // namespace

Expected<std::unique_ptr<WornJoints>> WornJoints::create(const DeviceOptions& options) {
  if (!options.joint_gains.gain.empty())
    if (const auto good = check(options.joint_gains); !good) return tl::unexpected(good.error());
  std::unique_ptr<Device> tracker;
  if (!options.wrist_port.empty()) {
    DeviceOptions wrist = options;
    wrist.port = options.wrist_port;
    wrist.sites = {Site::back_of_hand};
    auto made = create_nest_of_birds(wrist);
    if (!made) return tl::unexpected(made.error());
    tracker = std::move(*made);
  }
  return std::unique_ptr<WornJoints>(new WornJoints(options, std::move(tracker)));
}

WornJoints::WornJoints(const DeviceOptions& options, std::unique_ptr<Device> tracker)
    : path_(options.port),
      left_(options.left),
      left_to_right_T_(left_to_right(options.X_WT)),
      gains_(options.joint_gains),
      tracker_(std::move(tracker)) {
  const Pose X_TH = options.X_WT.inverse() * options.scene.X_WH;
  resting_.p_TS = X_TH.translation();
  resting_.q_TS = Eigen::Quaterniond(X_TH.linear());
}

void WornJoints::start(DeviceSink sink) {
  sink_ = std::move(sink);
  if (!tracker_) return;
  tracker_->start({.frame =
                       [this](const Frame& frame) {
                         const std::lock_guard lock(mutex_);
                         seen_ = frame.readings.at(0);
                         seen_at_ = Clock::now();
                       },
                   .degraded = sink_.degraded,
                   .drop = sink_.drop});
}

void WornJoints::begin(std::size_t sensors) {
  clock_.restart();
  if (gains_.gain.size() == sensors) return;
  if (!gains_.gain.empty())
    log::warning("{}: the calibration is for {} sensors, the glove has {}", path_,
                 gains_.gain.size(), sensors);
  log::warning("{}: typical gains are used; calibrate for right joint angles", path_);
  gains_ = *typical_gains(sensors);
}

void WornJoints::deliver(std::vector<double> counts, std::optional<std::vector<std::uint8_t>> held,
                         Time now) {
  Frame frame;
  frame.sequence = sequence_++;
  frame.stamp = clock_.stamp(now);
  frame.readings.push_back(wrist());
  frame.joint_counts = std::move(counts);
  const model::HumanPosture posture = joint_angles(frame.joint_counts, gains_);
  frame.joint_angles.assign(posture.begin(), posture.end());
  // Joint angles are those of either hand; a tracker's pose is mirrored, the scene's is not.
  if (left_ && tracker_) frame = mirrored(std::move(frame), left_to_right_T_);
  frame.left = left_;
  frame.held = std::move(held);
  sink_.frame(std::move(frame));
}

Reading WornJoints::wrist() {
  if (!tracker_) return resting_;
  const std::lock_guard lock(mutex_);
  Reading reading = seen_;
  reading.valid = reading.valid && Clock::now() - seen_at_ <= wrist_memory;
  return reading;
}

}  // namespace prehend::glove
