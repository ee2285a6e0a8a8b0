#include "common/arm/mounting.hpp"

#include <algorithm>

namespace prehend::arm {

Pose mounted(const model::HandModel& hand) {
  const Pose X_GB = hand.X_BG().inverse();
  double back = 0;  // lowest z in G that the base has
  for (const model::CollisionShape& shape : hand.links().front().collision) {
    const Pose X_GS = X_GB * shape.X_LS;
    const Eigen::Vector3d half = model::half_extents(shape.shape);
    back = std::min(back, X_GS.translation().z() - X_GS.linear().row(2).cwiseAbs().dot(half));
  }
  Pose X_FG = Pose::Identity();
  X_FG.translation().z() = -back;
  return X_FG * X_GB;
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
