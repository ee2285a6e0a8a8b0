#include "common/model/human_hand.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/base/named_values.hpp"

namespace prehend::model {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double degree = std::numbers::pi / 180;

// The kinematics are those of the 20-DoF human hand of GraspIt!, whose frame (here A) has its
// fingers along -x, the back of the hand along +y and the thumb at +z.

/// One joint and the segment behind it: RotZ(q + offset) Trans(length, 0, 0) RotX(twist).
struct Segment {
  double offset, length, twist;
  double lower, upper;
};

struct FingerModel {
  Matrix3d R_AF;  // base of the finger
  Vector3d p_AF;  // m
  std::array<Segment, 4> segments;
  double radius;    // m, of the segments
  int first_drawn;  // first segment that can touch an object
};

constexpr double finger_radius = 0.008;  // 16 mm thick
constexpr double thumb_radius = 0.010;

/// Origin of H in A: on the skin over the middle of the third metacarpal.
const Vector3d p_AH(-0.090, 0.0242, 0.0084);

Matrix3d rotation_of_H() {
  Matrix3d R_AH;
  R_AH.col(0) = -Vector3d::UnitX();
  R_AH.col(1) = Vector3d::UnitZ();
  R_AH.col(2) = Vector3d::UnitY();
  return R_AH;
}

FingerModel finger(const Vector3d& p_AF, double abduction, double mcp, double pip, double dip) {
  // In the source the lengths run along -x; here a half turn about the axis of abduction lets them
  // run along +x of each segment. Flexion stays positive toward the palm.
  const Matrix3d R_AF = (AngleAxisd(-std::numbers::pi / 2, Vector3d::UnitX()) *
                         AngleAxisd(std::numbers::pi, Vector3d::UnitZ()))
                            .toRotationMatrix();
  return {R_AF,
          p_AF,
          {{{0, 0, -90 * degree, -abduction * degree, abduction * degree},
            {0, mcp, 0, -10 * degree, 90 * degree},
            {0, pip, 0, -10 * degree, 90 * degree},
            {0, dip, 0, -10 * degree, 90 * degree}}},
          finger_radius,
          1};
}

FingerModel thumb() {
  Matrix3d R_AF;                     // column-major as listed
  R_AF << -0.1486, 0.2665, -0.9522,  //
      -0.9003, 0.3618, 0.2418,       //
      0.4089, 0.8933, 0.1862;
  // The source has its last segment along z of a frame turned by 85 degrees; here it runs along x.
  // Its length, 30 mm, is ours: the source gives only a mesh.
  return {nearest_rotation(R_AF).value(),  // the source has four digits
          Vector3d(-0.0506241, -0.0115082, 0.0189317),
          {{{0, 0, 90 * degree, -10 * degree, 70 * degree},
            {49.5 * degree, 0.0521193, 44 * degree, -50 * degree, 25 * degree},
            {5 * degree, 0.0407638, 0, 0, 90 * degree},
            {-5 * degree, 0.030, 0, 0, 100 * degree}}},
          thumb_radius,
          2};
}

/// In the order of Finger; a posture has the thumb last.
const std::array<FingerModel, finger_count>& finger_models() {
  static const std::array<FingerModel, finger_count> models{
      thumb(), finger({-0.14006, 0.01120, 0.03642}, 20, 0.04319, 0.02956, 0.02535),
      finger({-0.14566, 0.01120, 0.00840}, 10, 0.04620, 0.03099, 0.02920),
      finger({-0.14566, 0.00560, -0.01961}, 20, 0.03912, 0.02831, 0.02448),
      finger({-0.13446, -0.00840, -0.04202}, 30, 0.02991, 0.02110, 0.02316)};
  return models;
}

int first_dof(int f) {
  return f == static_cast<int>(Finger::thumb) ? 16 : 4 * (f - 1);
}

/// X_HS of the finger's base and behind each of its four joints. Bones are `length` times as long
/// as those of a hand of that scale.
std::array<Pose, 5> chain(int f, const HumanPosture& posture, double scale, double length) {
  const FingerModel& model = finger_models()[static_cast<std::size_t>(f)];
  const Matrix3d R_HA = rotation_of_H().transpose();
  std::array<Pose, 5> X_HS;
  X_HS[0] = make_pose(scale * (R_HA * (model.p_AF - p_AH)), Matrix3d(R_HA * model.R_AF));
  for (int j = 0; j < 4; ++j) {
    const Segment& s = model.segments[static_cast<std::size_t>(j)];
    X_HS[j + 1] = X_HS[j] * AngleAxisd(posture[first_dof(f) + j] + s.offset, Vector3d::UnitZ()) *
                  Eigen::Translation3d(scale * length * s.length, 0, 0) *
                  AngleAxisd(s.twist, Vector3d::UnitX());
  }
  return X_HS;
}

std::vector<Capsule> capsules(int f, const HumanPosture& posture, double scale, double length) {
  const FingerModel& model = finger_models()[static_cast<std::size_t>(f)];
  const auto X_HS = chain(f, posture, scale, length);
  std::vector<Capsule> result;
  for (int j = model.first_drawn; j < 4; ++j)
    result.push_back({X_HS[j].translation(), X_HS[j + 1].translation(), scale * model.radius});
  // The last joint's segment ends in a round tip: its axis stops a radius before the end.
  Capsule& tip = result.back();
  tip.b -= tip.radius * (tip.b - tip.a).normalized();
  return result;
}

/// Least distance between the capsule's surface and the object's; a few points along the axis are
/// exact enough for segments that are short beside the objects (error below 0.5 mm).
double clearance(const Capsule& capsule, const Shape& shape, const Pose& X_OH) {
  constexpr int steps = 8;
  double least = INFINITY;
  for (int i = 0; i <= steps; ++i) {
    const Vector3d p_H = capsule.a + (capsule.b - capsule.a) * (static_cast<double>(i) / steps);
    least = std::min(least, signed_distance(shape, X_OH * p_H) - capsule.radius);
  }
  return least;
}

}  // namespace

std::optional<Finger> finger_from_string(std::string_view name) {
  return finger_names.value(name);
}

HumanHand::HumanHand(double scale, const std::array<double, finger_count>& fingers)
    : scale_(std::clamp(scale, 0.7, 1.4)), fingers_(fingers) {
  for (double& length : fingers_) length = std::clamp(length, 0.7, 1.4);
}

std::array<double, 3> HumanHand::bones(Finger finger) const {
  const auto f = static_cast<std::size_t>(finger);
  std::array<double, 3> lengths{};
  for (std::size_t j = 0; j < lengths.size(); ++j)
    lengths[j] = scale_ * fingers_[f] * finger_models()[f].segments[j + 1].length;
  return lengths;
}

Vector3d HumanHand::base(Finger finger) const {
  const auto f = static_cast<std::size_t>(finger);
  return scale_ * (rotation_of_H().transpose() * (finger_models()[f].p_AF - p_AH));
}

std::array<Pose, finger_count> HumanHand::fingertip_poses(const HumanPosture& posture) const {
  std::array<Pose, finger_count> tips;
  for (int f = 0; f < finger_count; ++f) tips[f] = chain(f, posture, scale_, fingers_[f])[4];
  return tips;
}

std::vector<Capsule> HumanHand::segments(const HumanPosture& posture) const {
  std::vector<Capsule> result;
  for (int f = 0; f < finger_count; ++f)
    for (const Capsule& capsule : capsules(f, posture, scale_, fingers_[f]))
      result.push_back(capsule);
  return result;
}

HumanPosture HumanHand::clamp(const HumanPosture& posture) const {
  HumanPosture result;
  for (int f = 0; f < finger_count; ++f)
    for (int j = 0; j < 4; ++j) {
      const Segment& s = finger_models()[f].segments[j];
      result[first_dof(f) + j] = std::clamp(posture[first_dof(f) + j], s.lower, s.upper);
    }
  return result;
}

Pose HumanHand::X_HG() const {
  // Between thumb and fingers where they meet around an object of 4 to 6 cm. The fingers lean
  // forward while they close, so the approach leans 25 degrees from the palm's normal toward them.
  const double lean = 25 * degree;
  Matrix3d R_HG;
  R_HG.col(0) = Vector3d::UnitY();
  R_HG.col(1) = Vector3d(std::cos(lean), 0, std::sin(lean));
  R_HG.col(2) = Vector3d(std::sin(lean), 0, -std::cos(lean));
  return make_pose(scale_ * Vector3d(0.066, 0.005, -0.100), R_HG);
}

HumanPosture HumanHand::open_posture() {
  HumanPosture q;
  q << 0.10, 0.00, 0.10, 0.05,   // index
      0.00, 0.00, 0.10, 0.05,    // middle
      -0.10, -0.05, 0.10, 0.05,  // ring
      -0.20, -0.15, 0.10, 0.05,  // little
      0.09, -0.75, 0.05, 0.00;   // thumb: opposed and wide open
  return q;
}

HumanPosture HumanHand::fist_posture() {
  HumanPosture q;
  q << 0.00, 1.50, 1.50, 1.00,  // index
      0.00, 1.50, 1.50, 1.00,   // middle
      0.00, 1.50, 1.50, 1.00,   // ring
      0.00, 1.50, 1.50, 1.00,   // little
      0.00, 0.00, 0.70, 0.45;   // thumb: across the fingers
  return q;
}

HumanPosture HumanHand::posture(const std::array<double, finger_count>& closure) {
  const HumanPosture open = open_posture(), fist = fist_posture();
  HumanPosture q;
  for (int f = 0; f < finger_count; ++f) {
    const double c = std::clamp(std::isfinite(closure[f]) ? closure[f] : 0.0, 0.0, 1.0);
    const int d = first_dof(f);
    q.segment<4>(d) = (1 - c) * open.segment<4>(d) + c * fist.segment<4>(d);
  }
  return q;
}

std::array<double, finger_count> HumanHand::close_on(const Shape& shape, const Pose& X_HO) const {
  const Pose X_OH = X_HO.inverse();
  std::array<double, finger_count> closure{};
  for (int f = 0; f < finger_count; ++f) {
    const auto free = [&](double c) {
      std::array<double, finger_count> trial{};
      trial[f] = c;
      for (const Capsule& capsule : capsules(f, posture(trial), scale_, fingers_[f]))
        if (clearance(capsule, shape, X_OH) <= 0) return false;
      return true;
    };
    // Coarse steps find the first contact, halving then refines it to the last free closure.
    constexpr int steps = 64;
    int step = 0;
    while (step <= steps && free(static_cast<double>(step) / steps)) ++step;
    if (step == 0) continue;  // touches already when open
    double low = static_cast<double>(step - 1) / steps, high = static_cast<double>(step) / steps;
    if (step <= steps)
      for (int i = 0; i < 10; ++i) {
        const double middle = (low + high) / 2;
        (free(middle) ? low : high) = middle;
      }
    closure[f] = low;
  }
  return closure;
}

}  // namespace prehend::model
