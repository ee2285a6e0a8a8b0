#include "robot_grasps.hpp"

#include <algorithm>
#include <optional>
#include <prehend/grasping/closing.hpp>
#include <prehend/model/placement.hpp>

namespace prehend::mapping {

namespace {

using Eigen::Vector3d;

std::string type_of(const model::Shape& shape, const Pose& X_OG) {
  if (std::abs(X_OG.linear()(2, 2)) < 0.7) return "power wrap";
  return shape.kind == model::ShapeKind::box ? "precision" : "circular sphere";
}

/// True if no part of the hand is below the table, z = bottom in O, anywhere between the two
/// postures. Parts count as boxes; the palm is where the reach of the hand allows it to be.
bool above_table(const model::HandModel& hand, const Pose& X_OB, const Eigen::VectorXd& from,
                 const Eigen::VectorXd& to, double bottom) {
  constexpr int steps = 8;
  for (int step = 0; step <= steps; ++step) {
    const Eigen::VectorXd dof = from + (to - from) * (static_cast<double>(step) / steps);
    const std::vector<Pose> X_BL = hand.link_poses(hand.joint_angles(dof));
    for (std::size_t link = 1; link < X_BL.size(); ++link)
      for (const model::CollisionShape& part : hand.links()[link].collision) {
        const Pose X_OS = X_OB * X_BL[link] * part.X_LS;
        const double below =
            X_OS.linear().row(2).cwiseAbs().dot(model::half_extents(part.shape).transpose());
        if (X_OS.translation().z() - below < bottom) return false;
      }
  }
  return true;
}

}  // namespace

std::vector<Pose> approaches(const model::Shape& shape, const model::Reach& reach) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  std::vector<Pose> seeds{make_pose(Vector3d::Zero(), model::grasp_axes(-z, y)),
                          make_pose(Vector3d::Zero(), model::grasp_axes(x, y))};
  // Turning about a round object's axis is nothing new.
  if (shape.kind == model::ShapeKind::box) {
    seeds.push_back(make_pose(Vector3d::Zero(), model::grasp_axes(-z, x)));
    seeds.push_back(make_pose(Vector3d::Zero(), model::grasp_axes(y, x)));
  }
  std::vector<Pose> found;
  for (const Pose& seed : seeds) {
    const auto grasp = model::nearest_grasp(shape, seed, reach);
    const auto same = [&](const Pose& other) {
      return angle_between(other.linear(), grasp->linear()) < 0.1;
    };
    // What came out far from what was asked answers another approach.
    if (grasp && angle_between(seed.linear(), grasp->linear()) < 0.1 &&
        std::none_of(found.begin(), found.end(), same))
      found.push_back(*grasp);
  }
  return found;
}

Expected<RobotGrasp> robot_grasp(const model::HandModel& hand, const Scheme& scheme,
                                 const model::CatalogueObject& object, const Pose& X_OG) {
  const Pose X_BO = hand.X_BG() * X_OG.inverse();
  const grasping::Body body{object.name, object.shape, object.mass, object.material, {}};
  grasping::ClosingOptions options;
  options.down_B = X_BO.linear() * -Vector3d::UnitZ();

  const double table = -model::half_extents(object.shape).z();
  struct Closed {
    const Eigen::VectorXd* preshape;
    grasping::ClosedGrasp grasp;
  };
  std::vector<Closed> closed;
  Error last;
  for (const Eigen::VectorXd& preshape : scheme.preshapes) {
    auto grasp = grasping::close_hand(hand, body, X_BO, preshape, options);
    if (!grasp)
      last = grasp.error();
    else if (!above_table(hand, X_BO.inverse(), preshape, grasp->dof, table))
      last = {"fingers would reach into the table", object.name, ""};
    else
      closed.push_back({&preshape, std::move(*grasp)});
  }
  if (closed.empty()) return tl::unexpected(last);
  std::stable_sort(closed.begin(), closed.end(), [](const Closed& a, const Closed& b) {
    return a.grasp.quality.epsilon > b.grasp.quality.epsilon;
  });
  // The lift costs most of the time: only until one holds, best first.
  options.hold_test = grasping::HoldOptions{};
  const Closed* best = nullptr;
  bool held = false;
  for (const Closed& candidate : closed) {
    const auto lifted = grasping::close_hand(hand, body, X_BO, *candidate.preshape, options);
    if (!lifted || !lifted->hold || !lifted->hold->held) continue;
    best = &candidate;
    held = true;
    break;
  }
  if (!best) best = &closed.front();
  return RobotGrasp{object.name,     type_of(object.shape, X_OG), object.shape, X_OG,
                    best->grasp.dof, best->grasp.quality.epsilon, held};
}

}  // namespace prehend::mapping
