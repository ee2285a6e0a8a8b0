#include "services/glove/core/bare_hand.hpp"

namespace prehend::glove {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Places in H of an average hand, m (see model::HumanHand): the middle knuckle, the base of the
/// thumb, and, guessed, the middle of the wrist.
const Vector3d p_HKnuckle(0.0557, 0.0, -0.013);
const Vector3d p_HThumb(-0.0394, 0.0105, -0.0357);
const Vector3d p_HWrist(-0.060, 0.0, -0.020);

/// Frame with x along x_R and z as near to z_R as that allows; none if they span no plane.
std::optional<Matrix3d> rotation_of(const Vector3d& x_R, const Vector3d& z_R) {
  const Vector3d y = z_R.cross(x_R);
  if (!(x_R.norm() > 1e-6) || !(y.norm() > 1e-3 * x_R.norm() * z_R.norm())) return std::nullopt;
  Matrix3d R;
  R.col(0) = x_R.normalized();
  R.col(1) = y.normalized();
  R.col(2) = R.col(0).cross(R.col(1));
  return R;
}

}  // namespace

BareHand bare_hand(const Landmarks& p_R, bool left) {
  BareHand hand;
  hand.left = left;
  hand.x_R = p_R[9] - p_R[0];
  // Wrist, index knuckle and little knuckle span the back of a right hand.
  hand.z_R = (p_R[17] - p_R[0]).cross(p_R[5] - p_R[0]);
  if (left) hand.z_R = -hand.z_R;
  hand.knuckle_R = p_R[9];
  for (std::size_t f = 0; f < model::finger_count; ++f) {
    hand.tip_R[f] = p_R[4 * f + 4];
    hand.before_R[f] = p_R[4 * f + 3];
  }
  return hand;
}

void mirror(BareHand& hand, const Vector3d& normal_R) {
  const auto flip = [&](Vector3d& v) { v -= 2 * normal_R.dot(v) * normal_R; };
  flip(hand.x_R);
  flip(hand.z_R);
  flip(hand.knuckle_R);
  for (auto& p : hand.tip_R) flip(p);
  for (auto& p : hand.before_R) flip(p);
}

std::optional<Frame> sensors_on(const BareHand& hand, double hand_scale,
                                const std::optional<Pose>& X_TH) {
  const auto R_RH = rotation_of(hand.x_R, hand.z_R);
  if (!R_RH) return std::nullopt;
  const Pose X_RH = make_pose(hand.knuckle_R - *R_RH * (hand_scale * p_HKnuckle), *R_RH);
  const Pose X_TR = X_TH ? *X_TH * X_RH.inverse() : Pose::Identity();
  const Pose hand_T = X_TR * X_RH;

  Frame frame;
  frame.left = hand.left;
  frame.readings.push_back(
      {Site::back_of_hand, true, hand_T.translation(), Eigen::Quaterniond(hand_T.linear())});
  constexpr std::array sites{Site::thumb, Site::index, Site::middle, Site::ring, Site::little};
  for (std::size_t f = 0; f < sites.size(); ++f) {
    Reading reading{sites[f]};
    const auto R_RF = rotation_of(hand.tip_R[f] - hand.before_R[f], R_RH->col(2));
    reading.p_TS = X_TR * hand.tip_R[f];
    // A fingertip that points along the normal has no orientation of its own: take the hand's.
    reading.q_TS = Eigen::Quaterniond(X_TR.linear() * R_RF.value_or(*R_RH));
    frame.readings.push_back(reading);
  }
  return frame;
}

Landmarks landmarks_of(const model::HumanHand& hand, const model::HumanPosture& posture) {
  const auto tips = hand.fingertip_poses(posture);
  const auto segments = hand.segments(posture);  // two of the thumb, then three of each finger
  Landmarks points;
  points[0] = hand.scale() * p_HWrist;
  points[1] = hand.scale() * p_HThumb;
  points[2] = segments[0].a;
  points[3] = segments[1].a;
  for (std::size_t f = 0; f < tips.size(); ++f) {
    points[4 * f + 4] = tips[f].translation();
    for (std::size_t j = 0; f > 0 && j < 3; ++j)
      points[4 * f + 1 + j] = segments[2 + 3 * (f - 1) + j].a;
  }
  return points;
}

}  // namespace prehend::glove
