#include "services/glove/core/processor.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "services/glove/core/features.hpp"

namespace prehend::glove {
namespace {

using Eigen::Vector3d;

constexpr double farthest = 5;  // m from the transmitter, twice what any tracker reaches

/// A fingertip is at most its bones' lengths from where its finger begins; who has not been
/// measured may be a third longer, and sensors sit somewhat off.
constexpr double longer = 1.35, off = 0.03;  // off in m

/// rad, that a glove's joint angle may lie outside of what joints do: fingers bend further and
/// calibrations are worse than the average; more is a broken sensor.
constexpr double beyond_limits = 0.7;

/// The end of a unit axis moves as far as the angle turns: 300 rad/s², 15 rad/s, 0.1 rad of noise.
constexpr GateOptions turning{
    .noise = 0.1, .onset = 300, .acceleration = 300, .farthest = 2, .agreement = 15};
/// Relative to the hand, fingers are slower than the arm.
constexpr GateOptions bending{.acceleration = 25, .agreement = 1.5};

/// m, that a finger may have gone on meanwhile when its last place is still given.
constexpr double carried_past = 0.002;
constexpr double speed_memory = 0.05;  // s

/// The pose of a reading; `reason` says why there is none.
std::optional<Pose> checked(const Reading& reading, std::string_view& reason) {
  if (!reading.valid) {
    reason = "not valid";
  } else if (!reading.p_TS.allFinite() || !reading.q_TS.coeffs().allFinite()) {
    reason = "not finite";
  } else if (reading.q_TS.norm() < 1e-6) {
    reason = "zero norm";
  } else if (is_identity_pose(reading)) {
    reason = "identity pose";
  } else if (reading.p_TS.norm() > farthest) {
    reason = "extreme point";
  } else {
    return make_pose(reading.p_TS, reading.q_TS.normalized());
  }
  return std::nullopt;
}

std::string_view reason_of(PointGate::Verdict verdict) {
  return verdict == PointGate::Verdict::extreme ? "extreme point" : "unconfirmed";
}

}  // namespace

Processor::Processor(const ProcessorOptions& options)
    : options_(options),
      hand_gate_(GateOptions{}),
      x_gate_(turning),
      z_gate_(turning),
      hand_filter_(OneEuroOptions{}),
      hand_rotation_(OneEuroOptions{.slope = 5}) {
  for (std::size_t f = 0; f < fingers_.size(); ++f) {
    const auto which = static_cast<model::Finger>(f);
    const auto bones = options.hand.bones(which);
    fingers_[f].base = options.hand.base(which);
    fingers_[f].reach = longer * std::accumulate(bones.begin(), bones.end(), 0.0) + off;
  }
}

Processor::Finger::Finger() : gate(bending), filter(OneEuroOptions{}) {}

Processed Processor::process(const Frame& frame, Time now) {
  Processed result;
  const double age = to_seconds(now - frame.stamp);
  if (age > options_.stale || age < -options_.stale) {
    result.rejects.push_back(age > 0 ? "stale" : "from the future");
    return result;
  }
  if (last_ && frame.stamp <= *last_) {
    result.rejects.push_back("out of order");
    return result;
  }
  before_ = last_;
  last_ = frame.stamp;

  const std::optional<Pose> X_TH = back_of_hand(frame, result);
  if (!X_TH) return result;
  if (std::count_if(frame.readings.begin(), frame.readings.end(),
                    [](const Reading& reading) { return reading.site == Site::back_of_hand; }) > 1)
    result.rejects.push_back("second hand");

  const auto q = angles(frame, result);
  Posture posture;
  posture.sequence = frame.sequence;
  posture.stamp = frame.stamp;
  if (q) posture.joint_angles.assign(q->begin(), q->end());
  const Pose X_WH = options_.X_WT * *X_TH;
  posture.X_WH = make_pose(hand_filter_(frame.stamp, X_WH.translation()),
                           hand_rotation_(frame.stamp, Eigen::Quaterniond(X_WH.linear())));

  int sensors = 1, good = 1;
  std::array<bool, model::finger_count> done{};
  const auto take = [&](std::size_t f, const std::optional<Vector3d>& p_HF) {
    done[f] = true;
    ++sensors;
    Finger& finger = fingers_[f];
    if (p_HF && follow(finger, frame.stamp, *p_HF, result)) ++good;
    posture.fingertips[f].valid = can_be_carried(finger, frame.stamp);
    if (posture.fingertips[f].valid) posture.fingertips[f].p_HF = finger.p_HF;
  };
  for (const Reading& reading : frame.readings) {
    const auto which = finger_of(reading.site);
    if (!which) continue;
    const auto f = static_cast<std::size_t>(*which);
    if (done[f])
      result.rejects.push_back("second hand");  // a site counts once
    else
      take(f, sensed(reading, *X_TH, result));
  }
  if (!frame.joint_angles.empty()) {
    const auto tips = options_.hand.fingertip_poses(q.value_or(model::HumanPosture::Zero()));
    for (std::size_t f = 0; f < tips.size(); ++f)
      if (!done[f]) take(f, q ? std::optional<Vector3d>(tips[f].translation()) : std::nullopt);
  }
  posture.quality = static_cast<double>(good) / sensors;
  result.posture = std::move(posture);
  return result;
}

bool Processor::can_be_carried(const Finger& finger, Time stamp) const {
  if (!finger.seen) return false;
  const double unseen = to_seconds(stamp - *finger.seen);
  return unseen <= options_.carry && finger.speed * unseen <= carried_past;
}

std::optional<Pose> Processor::back_of_hand(const Frame& frame, Processed& result) {
  for (const Reading& reading : frame.readings) {
    if (reading.site != Site::back_of_hand) continue;
    std::string_view reason;
    const std::optional<Pose> X_TH = checked(reading, reason);
    if (!X_TH) {
      result.rejects.push_back(reason);
      return std::nullopt;
    }
    // Every gate sees every reading, so that all of them confirm a jump together.
    for (const auto verdict : {hand_gate_.check(frame.stamp, X_TH->translation()),
                               x_gate_.check(frame.stamp, X_TH->linear().col(0)),
                               z_gate_.check(frame.stamp, X_TH->linear().col(2))})
      if (verdict != PointGate::Verdict::good) {
        result.rejects.push_back(reason_of(verdict));
        return std::nullopt;
      }
    return X_TH;
  }
  result.rejects.push_back("no back of hand");
  return std::nullopt;
}

std::optional<Vector3d> Processor::sensed(const Reading& reading, const Pose& X_TH,
                                          Processed& result) {
  std::string_view reason;
  const std::optional<Pose> X_TS = checked(reading, reason);
  if (!X_TS) {
    result.rejects.push_back(reason);
    return std::nullopt;
  }
  // The unfiltered hand: a filtered one lags, and its lag would look like bent fingers.
  return invariant_feature(X_TH, X_TS->translation());
}

std::optional<model::HumanPosture> Processor::angles(const Frame& frame, Processed& result) const {
  if (frame.joint_angles.empty()) return std::nullopt;
  if (frame.joint_angles.size() != model::human_dof_count) {
    result.rejects.push_back("not the joints of a hand");
    return std::nullopt;
  }
  const Eigen::Map<const model::HumanPosture> measured(frame.joint_angles.data());
  if (!measured.allFinite()) {
    result.rejects.push_back("not finite");
    return std::nullopt;
  }
  const model::HumanPosture q = options_.hand.clamp(measured);
  if ((measured - q).lpNorm<Eigen::Infinity>() > beyond_limits) {
    result.rejects.push_back("extreme angle");
    return std::nullopt;
  }
  return q;
}

bool Processor::follow(Finger& finger, Time stamp, const Vector3d& p_HF, Processed& result) {
  if ((p_HF - finger.base).norm() > finger.reach) {
    result.rejects.push_back("extreme point");
    return false;
  }
  const PointGate::Verdict verdict = finger.gate.check(stamp, p_HF);
  if (verdict != PointGate::Verdict::good) {
    result.rejects.push_back(reason_of(verdict));
    // Elsewhere, and not seen in the frame before either: the finger may well have gone.
    if (finger.seen != before_) finger.seen.reset();
    return false;
  }
  const Vector3d p_HF_filtered = finger.filter(stamp, p_HF);
  if (finger.seen) {
    const double dt = to_seconds(stamp - *finger.seen);
    finger.speed = std::max((p_HF_filtered - finger.p_HF).norm() / dt,
                            finger.speed * std::exp(-dt / speed_memory));
  }
  finger.p_HF = p_HF_filtered;
  finger.seen = stamp;
  return true;
}

}  // namespace prehend::glove
