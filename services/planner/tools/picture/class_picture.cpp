#include "services/planner/tools/picture/class_picture.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/model/human_hand.hpp"
#include "services/planner/tools/picture/grasp_picture.hpp"

namespace prehend::planner {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using model::Finger;
using model::GraspClass;
using model::GraspForm;
using model::HumanHand;
using model::Opposition;
using model::Shape;
using model::ShapeKind;

const Paint skin{{0.90, 0.72, 0.60}, 0.15}, thing{{0.10, 0.50, 0.72}, 0.2, 0.75};
constexpr double bar = 0.14, disk = 0.025, flat_depth = 0.05, flat_length = 0.08;  // m
constexpr double palm = -0.030, palm_middle = 0.045;  // m, z of its skin and x of its middle in H
constexpr double palm_radius = 0.011;                 // m, of what stands for the palm
const Vector3d wrist(-0.045, 0, -0.015);              // m, in H
constexpr double stretched = 0.05, bent_away = 0.75;  // closure of fingers that take no part

Shape usual_object(const GraspClass& kind) {
  const double width = std::sqrt(kind.min_width * kind.max_width);
  const bool is_disk = kind.name.ends_with("disk");
  switch (kind.shapes.front()) {
    case ShapeKind::box:
      if (kind.form == GraspForm::flat) return {ShapeKind::box, {width, flat_depth, flat_length}};
      return {ShapeKind::box, {width, width, bar}};
    case ShapeKind::sphere:
      return {ShapeKind::sphere, Vector3d::Constant(width / 2)};
    default:
      return {ShapeKind::cylinder, {width / 2, width / 2, is_disk ? disk : bar}};
  }
}

Matrix3d axes(const Vector3d& x, const Vector3d& z) {
  Matrix3d R;
  R << x, z.cross(x), z;
  return R;
}

/// Where the object is in the hand.
Pose place_of(const GraspClass& kind, const Shape& shape, const HumanHand& hand,
              const model::HumanPosture& idle) {
  const Vector3d half = model::half_extents(shape);
  const bool around = kind.form == GraspForm::circular;
  switch (kind.opposition) {
    case Opposition::palm: {
      const double depth = around ? half.z() : half.y();
      return make_pose({palm_middle, -0.005, palm - depth},
                       around ? axes(Vector3d::UnitX(), Vector3d::UnitZ())
                              : axes(Vector3d::UnitX(), Vector3d::UnitY()));
    }
    case Opposition::pad:
      return hand.X_HG() *
             make_pose(Vector3d::Zero(), around ? axes(Vector3d::UnitY(), -Vector3d::UnitZ())
                                                : axes(Vector3d::UnitY(), Vector3d::UnitX()));
    case Opposition::side:
      break;
  }
  const model::Capsule middle = hand.segments(idle)[3];  // of the index finger
  const Vector3d p = 0.5 * (middle.a + middle.b) + (middle.radius + half.x()) * Vector3d::UnitY();
  return make_pose(p, axes(Vector3d::UnitY(), Vector3d::UnitX()));
}

void put(std::vector<Triangle>& to, std::vector<Triangle> more) {
  to.insert(to.end(), more.begin(), more.end());
}

void put(std::vector<Triangle>& to, const model::Capsule& bone, const Pose& X_WH) {
  for (const Vector3d& end : {bone.a, bone.b})
    put(to, surface_of({ShapeKind::sphere, Vector3d::Constant(bone.radius)},
                       X_WH * make_pose(end, Matrix3d::Identity()), class_hand));
  const Vector3d way = bone.b - bone.a;
  const Matrix3d R = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), way).toRotationMatrix();
  put(to, surface_of({ShapeKind::cylinder, {bone.radius, bone.radius, way.norm()}},
                     X_WH * make_pose(0.5 * (bone.a + bone.b), R), class_hand));
}

}  // namespace

Drawing draw_class(const GraspClass& kind) {
  const HumanHand hand(1);
  const Shape shape = usual_object(kind);
  const bool side = kind.opposition == Opposition::side;
  const double away = side ? bent_away : stretched;
  const model::HumanPosture idle = HumanHand::posture({stretched, away, away, away, away});
  const Pose X_HO = place_of(kind, shape, hand, idle);
  const auto closed = hand.close_on(shape, X_HO);
  std::array<double, model::finger_count> closure{};
  closure.fill(away);
  closure[0] = kind.thumb == model::ThumbPlace::free ? stretched : closed[0];
  for (const Finger finger : kind.opposed)
    if (!side) closure[static_cast<std::size_t>(finger)] = closed[static_cast<std::size_t>(finger)];

  const Pose X_WH(Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX()));  // palm up
  Drawing made;
  made.paints = {skin, thing};
  for (const model::Capsule& bone : hand.segments(HumanHand::posture(closure)))
    put(made.triangles, bone, X_WH);
  for (int f = 0; f < model::finger_count; ++f)
    put(made.triangles, {wrist, hand.base(static_cast<Finger>(f)), palm_radius}, X_WH);
  put(made.triangles, surface_of(shape, X_WH * X_HO, class_object));
  made.floor = std::numeric_limits<double>::infinity();
  for (const Triangle& each : made.triangles)
    for (const Vector3d& p : each.p) made.floor = std::min(made.floor, p.z());
  return made;
}

Viewpoint view_of_class(const Drawing& drawing, double aspect) {
  return look_at(drawing, Vector3d(0.62, -0.48, 0.62).normalized(), aspect);
}

}  // namespace prehend::planner
