#include "services/demonstration/core/recognition/features.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace prehend::demonstration {

namespace {

constexpr Eigen::Index posture_count = 13, motion_count = 17;
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

void write_posture(const HandSample& sample, Eigen::Ref<Eigen::VectorXd> out) {
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
  if (inputs != Inputs::motion) write_posture(sample, made.head(posture_count));
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
