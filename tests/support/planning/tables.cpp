#include "tests/support/planning/tables.hpp"

#include <numbers>

#include "common/arm/mounting.hpp"
#include "common/base/random.hpp"
#include "tests/support/arms/arms.hpp"
#include "tests/support/hands.hpp"

namespace prehend::test {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

planning::Robot puma_with(const std::string& name) {
  const model::ArmModel& puma = arm("puma560");
  planning::Robot robot{&puma, &hand(name)};
  robot.X_WA = make_pose(Vector3d(0, -0.7, 0),
                         Eigen::Quaterniond(AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ())));
  robot.X_EB = puma.X_EF * arm::mounted(hand(name), 0.7);
  return robot;
}

planning::Query drawn_reach(const planning::Robot& robot, std::uint64_t seed) {
  Random random(seed);
  planning::Query query;
  query.start = robot.arm->home;
  const std::size_t count = 4 + random.index(3);
  while (query.scene.obstacles.size() < count) {
    const Vector3d p(random.uniform(-0.35, 0.35), random.uniform(-0.25, 0.2), 0);
    bool is_apart = true;
    for (const auto& other : query.scene.obstacles)
      is_apart &= (other.X_WO.translation() - p).head<2>().norm() > 0.2;
    if (!is_apart) continue;
    const double height = random.uniform(0.06, 0.22), width = random.uniform(0.04, 0.07);
    const bool is_box = random.uniform() < 0.5;
    const model::Shape shape =
        is_box ? model::Shape{model::ShapeKind::box, {width, 1.3 * width, height}}
               : model::Shape{model::ShapeKind::cylinder, {width / 2, width / 2, height}};
    const AngleAxisd turn(random.uniform(-3, 3), Vector3d::UnitZ());
    query.scene.obstacles.push_back(
        {{"thing " + std::to_string(query.scene.obstacles.size()), shape, {}},
         make_pose(p + Vector3d(0, 0, height / 2), turn.toRotationMatrix())});
  }
  const planning::Obstacle& target = query.scene.obstacles.front();
  // Approach from above, halfway, or level, and away from the arm.
  const double slope = std::array{1.0, 0.5, 0.15}[random.index(3)] * std::numbers::pi / 2;
  const double yaw = std::numbers::pi / 2 + random.uniform(-0.6, 0.6);
  const Vector3d way(std::cos(slope) * std::cos(yaw), std::cos(slope) * std::sin(yaw),
                     -std::sin(slope));
  const Vector3d closing = Vector3d::UnitZ().cross(Vector3d(std::cos(yaw), std::sin(yaw), 0));
  const double top = 2 * target.X_WO.translation().z();
  const Vector3d p(target.X_WO.translation().x(), target.X_WO.translation().y(),
                   std::max(0.06, top - 0.03));
  const Pose X_WG = make_pose(p, model::grasp_axes(way, closing));
  const Pose X_WB = X_WG * robot.hand->X_BG().inverse();
  query.X_WB = X_WB;
  query.X_WB.pretranslate(-0.12 * way);
  query.then = {X_WB};
  query.touched = target.solid.name;
  return query;
}

planning::Query drawn_carry(const planning::Robot& robot, const planning::Query& reach,
                            const arm::Joints& grasped, std::uint64_t seed) {
  Random random(seed + 77);
  planning::Query query;
  query.scene = reach.scene;
  query.scene.obstacles.erase(query.scene.obstacles.begin());
  const planning::Obstacle& target = reach.scene.obstacles.front();
  const Pose X_WB = robot.hand_at(grasped);
  // Lifted by 8 cm.
  const Pose X_BO = reach.then.front().inverse() * target.X_WO;
  query.scene.held = planning::Held{target.solid, X_BO};
  query.start = grasped;
  const Vector3d by(random.uniform(-0.3, 0.3), random.uniform(-0.2, 0.2), 0);
  const Pose X_WO = X_WB * X_BO;
  Pose goal = X_WO;
  goal.pretranslate(by - Vector3d(X_WO.translation().x(), X_WO.translation().y(), 0));
  query.X_WB = goal * X_BO.inverse();
  query.upright = planning::Upright{X_BO.linear().col(2)};
  return query;
}

}  // namespace prehend::test
