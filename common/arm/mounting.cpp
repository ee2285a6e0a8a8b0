#include "common/arm/mounting.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace prehend::arm {

Pose mounted(const model::HandModel& hand, double bend) {
  const Eigen::Matrix3d R_FG = Eigen::AngleAxisd(bend, Eigen::Vector3d::UnitY()).toRotationMatrix();
  Pose X_FB = make_pose(Eigen::Vector3d::Zero(), R_FG) * hand.X_BG().inverse();
  double back = 0;  // lowest z in F that the base has
  for (const model::CollisionShape& shape : hand.links().front().collision) {
    const Pose X_FS = X_FB * shape.X_LS;
    const Eigen::Vector3d half = model::half_extents(shape.shape);
    back = std::min(back, X_FS.translation().z() - X_FS.linear().row(2).cwiseAbs().dot(half));
  }
  X_FB.pretranslate(-back / R_FG(2, 2) * R_FG.col(2));
  return X_FB;
}

double weight_of(const model::HandModel& hand) {
  double mass = 0;
  for (const model::HandLink& link : hand.links()) mass += link.mass;
  return mass;
}

Expected<void> check_fit(const model::ArmModel& arm, const model::HandModel& hand) {
  const double mass = weight_of(hand);
  if (arm.payload > 0 && mass > arm.payload)
    return wrong_use(
        fmt::format("cannot carry {}, which weighs {:.2f} kg; its payload is {:.2f} kg",
                    hand.name(), mass, arm.payload),
        arm.name, "choose a lighter hand or a stronger arm");
  return {};
}

std::vector<model::Capsule> carried(const model::ArmModel& arm, const model::HandModel& hand) {
  const Pose X_LB = arm.X_LE * arm.X_EF * mounted(hand);
  const auto X_BL = hand.link_poses(hand.joint_angles(hand.postures().at("open")));
  std::vector<model::Capsule> capsules;
  for (std::size_t link = 0; link < X_BL.size(); ++link)
    for (const model::CollisionShape& shape : hand.links()[link].collision) {
      const model::Capsule part = model::capsule_around(shape);
      const Pose X = X_LB * X_BL[link];
      capsules.push_back({X * part.a, X * part.b, part.radius});
    }
  return capsules;
}

}  // namespace prehend::arm
