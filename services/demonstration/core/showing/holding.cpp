#include "services/demonstration/core/showing/holding.hpp"

#include <algorithm>
#include <array>
#include <numbers>

namespace prehend::demonstration {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using model::Finger;
using model::GraspClass;
using model::GraspForm;
using model::HumanHand;
using model::HumanPosture;
using model::Opposition;
using model::Shape;
using model::ShapeKind;

constexpr double palm = -0.030;        // m, z of the palm's skin in H
constexpr double palm_middle = 0.045;  // m, x in H, where what is held touches it
constexpr double pad = 0.006;          // m, from the end of a finger's axis to its skin
constexpr double max_spread = 0.35;    // rad, of fingers around something wide
constexpr double spread_from = 0.04, spread_to = 0.12;  // m, widths

/// Where fingers stand in a row, m along y of H; how they stand around something, rad from the
/// middle of the fingers; how much of a spread each takes.
constexpr std::array in_row{0.015, 0.030, 0.010, -0.010, -0.030};
constexpr std::array around_four{0.0, 0.9, 0.3, -0.3, -0.9};
constexpr std::array around_two{0.0, 0.5, -0.5, 0.0, 0.0};
constexpr std::array around_palm{2.1, 0.75, 0.2, -0.35, -0.9};  // from the fingers' direction
constexpr double beyond = 0.35;                                 // rad, the middle of a sphere
constexpr std::array share_of_spread{0.0, 1.0, 0.1, -0.6, -1.2};

/// What fills the palm slides along it, what the thumb presses on a finger along that.
const Slack in_palm{{0.03, 0.015, 0.004}, 0.15}, on_finger{{0.015, 0.002, 0.015}, 0.15};

double width_of(const Shape& shape) {
  return 2 * model::half_extents(shape).x();
}

Eigen::Ref<Eigen::Vector4d> joints_of(HumanPosture& posture, Finger finger) {
  const int f = static_cast<int>(finger);
  return posture.segment<4>(f == 0 ? 16 : 4 * (f - 1));
}

/// How far fingers stand apart for something so wide, 0 to 1.
double spread_for(const Shape& shape) {
  return std::clamp((width_of(shape) - spread_from) / (spread_to - spread_from), 0.0, 1.0);
}

/// A hand that is about to close.
HumanPosture preshaped(const HumanHand& hand, const GraspClass& kind, const Shape& shape,
                       const Manner& manner) {
  HumanPosture made = HumanHand::open_posture();
  HumanPosture idle = HumanHand::posture({0.3, manner.curl, manner.curl, manner.curl, manner.curl});
  if (kind.opposition == Opposition::side) made = idle;
  const bool around = kind.form == GraspForm::circular;
  if (kind.opposition == Opposition::pad || around)
    made = HumanHand::posture({0.4, 0.35, 0.35, 0.35, 0.35});
  for (int f = 1; f < model::finger_count; ++f) {
    const auto finger = static_cast<Finger>(f);
    if (!takes_part(kind, finger)) joints_of(made, finger) = joints_of(idle, finger);
    if (around)
      joints_of(made, finger)[0] = max_spread * spread_for(shape) * manner.row *
                                   share_of_spread[static_cast<std::size_t>(f)];
  }
  return hand.clamp(made + manner.posture);
}

/// Axes of an object in H. Across: what thumb and fingers press on; along: a bar's length.
Matrix3d bar_in_palm(double oblique) {
  Matrix3d R;
  R.col(0) = Vector3d::UnitX();
  R.col(2) = Vector3d::UnitY();
  R.col(1) = R.col(2).cross(R.col(0));
  return Eigen::AngleAxisd(-oblique, Vector3d::UnitZ()).toRotationMatrix() * R;
}

/// Of an object that is so deep, half of it.
Vector3d place_in_palm(const HumanHand& hand, double half_depth, const Manner& manner) {
  const Vector3d p = hand.scale() * Vector3d(palm_middle, -0.005, palm) + manner.place_H;
  return p - half_depth * Vector3d::UnitZ();
}

/// A bar.
Held wrapped_in_palm(const HumanHand& hand, const GraspClass& kind, const Shape& shape,
                     const Manner& manner) {
  const Pose X_HO = make_pose(place_in_palm(hand, model::half_extents(shape).y(), manner),
                              bar_in_palm(manner.oblique));
  return {wrapped(hand, preshaped(hand, kind, shape, manner), manner.bending, shape, X_HO), X_HO};
}

/// Of each finger that takes part, about an object whose width lies along y and whose length lies
/// along x (a bar) or z (what is held from all sides) of G.
std::vector<TipPlace> places_on(const HumanHand& hand, const GraspClass& kind, const Shape& shape,
                                const Manner& manner, const Matrix3d& R_GO) {
  std::vector<TipPlace> made;
  const double away = 0.5 * width_of(shape) + pad * hand.scale();
  const bool single = kind.opposed.size() == 1, bar = kind.form == GraspForm::prismatic;
  for (int f = 0; f < model::finger_count; ++f) {
    const auto finger = static_cast<Finger>(f);
    if (!takes_part(kind, finger)) continue;
    const auto i = static_cast<std::size_t>(f);
    Vector3d p_G;
    if (bar) {
      const double x = single ? 0.0 : hand.scale() * manner.row * in_row[i];
      p_G = {x, finger == Finger::thumb ? -away : away, 0};
    } else {
      const auto& around = kind.opposed.size() > 2 ? around_four : around_two;
      const double angle =
          finger == Finger::thumb ? std::numbers::pi : around[i] * manner.row + manner.reach_round;
      p_G = {away * std::sin(angle), away * std::cos(angle), 0};
    }
    made.push_back({finger, R_GO.transpose() * p_G});
  }
  return made;
}

Held at_fingertips(const HumanHand& hand, const GraspClass& kind, const Shape& shape,
                   const Manner& manner) {
  HumanPosture posture = preshaped(hand, kind, shape, manner);
  Matrix3d R_GO;  // axes of O in G
  if (kind.form == GraspForm::prismatic)
    R_GO << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  else
    R_GO << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  Pose X_HO = hand.X_HG() * Pose(Eigen::Quaterniond(R_GO));
  X_HO.pretranslate(manner.place_H);
  return pinched(hand, {posture, X_HO}, places_on(hand, kind, shape, manner, R_GO), Slack{});
}

/// Fingertips and thumb stand around what fills the palm: on the rim of a disk, beyond the middle
/// of a sphere, as deep on what is longer.
Held around_in_palm(const HumanHand& hand, const GraspClass& kind, const Shape& shape,
                    const Manner& manner) {
  const double half = model::half_extents(shape).z(), radius = 0.5 * width_of(shape);
  const Pose X_HO = make_pose(place_in_palm(hand, half, manner));
  const double away = radius + pad * hand.scale();
  const bool sphere = shape.kind == ShapeKind::sphere;
  // How far the tips are below its middle.
  const double depth = sphere
                           ? away * std::sin(beyond)
                           : std::clamp(radius * (1 + std::sin(beyond)) - half, -half, 0.5 * half);
  const double out = sphere ? away * std::cos(beyond) : away;
  std::vector<TipPlace> places;
  for (int f = 0; f < model::finger_count; ++f) {
    const double angle =
        (f == 0 ? around_palm[0] : around_palm[static_cast<std::size_t>(f)] * manner.row) +
        manner.reach_round;
    places.push_back(
        {static_cast<Finger>(f), {out * std::cos(angle), out * std::sin(angle), -depth}});
  }
  return pinched(hand, {preshaped(hand, kind, shape, manner), X_HO}, places, in_palm);
}

/// The thumb presses something flat on the side of the bent index finger.
Held at_the_side(const HumanHand& hand, const GraspClass& kind, const Shape& shape,
                 const Manner& manner) {
  HumanPosture posture = preshaped(hand, kind, shape, manner);
  const auto segments = hand.segments(posture);
  const model::Capsule& middle = segments[3];  // after two of the thumb and one of the index
  const double share = std::clamp(0.6 + 20 * manner.place_H.x(), 0.0, 1.0);
  const Vector3d side = Vector3d::UnitY();
  const Vector3d p_H =
      middle.a + share * (middle.b - middle.a) + (middle.radius + 0.5 * width_of(shape)) * side;
  Matrix3d R_HO;  // its thickness, x, lies across
  R_HO << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  const Pose X_HO = make_pose(p_H, R_HO);
  const Vector3d thumb(0.5 * width_of(shape) + pad * hand.scale(), 0, 0);
  return pinched(hand, {posture, X_HO}, {{Finger::thumb, thumb}}, on_finger);
}

}  // namespace

bool takes_part(const GraspClass& kind, Finger finger) {
  return finger == Finger::thumb ||
         std::find(kind.opposed.begin(), kind.opposed.end(), finger) != kind.opposed.end();
}

Held holding(const HumanHand& hand, const GraspClass& kind, const Shape& shape,
             const Manner& manner) {
  switch (kind.opposition) {
    case Opposition::palm:
      return kind.form == GraspForm::circular ? around_in_palm(hand, kind, shape, manner)
                                              : wrapped_in_palm(hand, kind, shape, manner);
    case Opposition::pad:
      return at_fingertips(hand, kind, shape, manner);
    case Opposition::side:
      break;
  }
  return at_the_side(hand, kind, shape, manner);
}

}  // namespace prehend::demonstration
