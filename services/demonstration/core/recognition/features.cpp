#include "services/demonstration/core/recognition/features.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace prehend::demonstration {

namespace {

// From the thumb: ten distances and three signed lengths. On the hand: of each fingertip three
// coordinates and how the finger stands there, and how large the hand is.
constexpr Eigen::Index from_thumb = 13, on_hand = model::finger_count * 6 + 1;
constexpr Eigen::Index posture_count = from_thumb + on_hand, motion_count = 17;
constexpr double slow = 0.02;        // m/s: below, speeds count alike
constexpr double short_time = 0.01;  // s
constexpr double no_length = 1e-9;   // m

Eigen::Vector3d direction(const Eigen::Vector3d& v) {
  const double length = v.norm();
  return length > no_length ? Eigen::Vector3d(v / length) : Eigen::Vector3d::Zero();
}

double signed_length(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return std::cbrt(a.dot(b.cross(c)));
}

void write_from_thumb(const HandSample& sample, Eigen::Ref<Eigen::VectorXd> out) {
  const auto& tips = sample.p_thumb_tip_W;
  Eigen::Index at = 0;
  for (std::size_t i = 0; i < tips.size(); ++i) {
    out[at++] = tips[i].norm();
    for (std::size_t k = i + 1; k < tips.size(); ++k) out[at++] = (tips[k] - tips[i]).norm();
  }
  out[at++] = signed_length(tips[0], tips[1], tips[2]);
  out[at++] = signed_length(tips[0], tips[1], tips[3]);
  out[at] = signed_length(tips[1], tips[2], tips[3]);
}

/// How a finger stands: how far it is stretched, how far it is bent towards the palm, how far it
/// is spread aside, as seen from its first joint in a hand of average size.
Eigen::Vector3d stance(const Eigen::Vector3d& p_HF, model::Finger finger) {
  static const model::HumanHand average(1);
  const Eigen::Vector3d d = p_HF - average.base(finger);
  return {d.norm(), std::atan2(-d.z(), d.x()), std::atan2(d.y(), std::hypot(d.x(), d.z()))};
}

/// Lengths are those of a hand of average size, so that large and small hands look alike.
void write_on_hand(const HandSample& sample, Eigen::Ref<Eigen::VectorXd> out) {
  const double scale = std::isfinite(sample.scale) ? sample.scale : 1;
  Eigen::Index at = 0;
  for (std::size_t f = 0; f < sample.p_HF.size(); ++f) {
    const Eigen::Vector3d p_HF = sample.p_HF[f] / scale;
    out.segment<3>(at) = p_HF;
    out.segment<3>(at + 3) = stance(p_HF, static_cast<model::Finger>(f));
    at += 6;
  }
  out[at] = sample.scale;
}

void write_motion(const HandSample& sample, Eigen::Ref<Eigen::VectorXd> out) {
  const auto& tips = sample.p_thumb_tip_W;
  Eigen::Index at = 0;
  for (const Eigen::Vector3d& tip : tips) {
    out.segment<3>(at) = direction(tip);
    at += 3;
  }
  out.segment<3>(at) = direction((tips[0] + tips[1]).cross(tips[3] - tips[0]));
  at += 3;
  out[at++] = std::log(slow + std::abs(sample.hand_speed));
  out[at] = std::log(slow + std::abs(sample.wrist_speed));
}

/// The larger one; the other one where one is unknown.
double larger(double a, double b) {
  return std::fmax(a, b);
}

}  // namespace

Eigen::Index feature_count(Inputs inputs) {
  switch (inputs) {
    case Inputs::posture:
      return posture_count;
    case Inputs::motion:
      return motion_count;
    case Inputs::both:
      break;
  }
  return posture_count + motion_count;
}

Eigen::Index summary_count(Inputs inputs) {
  return 2 * feature_count(inputs) + (inputs == Inputs::posture ? 0 : 3);
}

Eigen::VectorXd features(const HandSample& sample, Inputs inputs) {
  Eigen::VectorXd made(feature_count(inputs));
  if (inputs != Inputs::motion) {
    write_from_thumb(sample, made.head(from_thumb));
    write_on_hand(sample, made.segment(from_thumb, on_hand));
  }
  if (inputs != Inputs::posture) write_motion(sample, made.tail(motion_count));
  return made;
}

const Eigen::VectorXd& FeatureStream::add(const HandSample& sample) {
  Eigen::VectorXd now = features(sample, inputs_);
  if (last_.size() > 0)
    for (Eigen::Index i = 0; i < now.size(); ++i)
      if (!std::isfinite(now[i])) now[i] = last_[i];
  last_ = std::move(now);
  return last_;
}

Eigen::VectorXd Summary::add(const HandSample& sample) {
  const Eigen::VectorXd& now = stream_.add(sample);
  const Eigen::Index n = now.size();
  if (sum_.size() == 0) {
    begin_ = sample.t;
    first_ = now;
    sum_ = Eigen::VectorXd::Zero(n);
    counts_ = Eigen::VectorXi::Zero(n);
  }
  Eigen::VectorXd made(summary_count(inputs_));
  for (Eigen::Index i = 0; i < n; ++i) {
    if (std::isfinite(now[i])) {
      if (!std::isfinite(first_[i])) first_[i] = now[i];
      sum_[i] += now[i];
      ++counts_[i];
    }
    made[i] = counts_[i] > 0 ? sum_[i] / counts_[i] : unknown_number;
    made[n + i] = now[i] - first_[i];
  }
  if (inputs_ == Inputs::posture) return made;
  fastest_ = {larger(fastest_[0], sample.hand_speed), larger(fastest_[1], sample.wrist_speed)};
  made.tail<3>() = Eigen::Vector3d(std::log(short_time + std::max(0.0, sample.t - begin_)),
                                   std::log(slow + std::abs(fastest_[0])),
                                   std::log(slow + std::abs(fastest_[1])));
  return made;
}

}  // namespace prehend::demonstration
