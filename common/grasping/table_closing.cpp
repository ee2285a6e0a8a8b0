#include "common/grasping/table_closing.hpp"

#include <algorithm>

#include "common/grasping/closing.hpp"

namespace prehend::grasping {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double max_closing = 3;  // s, until the fingers must have stopped

/// True if no part of the hand is below the table, z = bottom in O, anywhere between the two
/// postures. Parts count as boxes; the palm is where the reach of the hand allows it to be.
bool above_table(const model::HandModel& hand, const Pose& X_OB, const VectorXd& from,
                 const VectorXd& to, double bottom) {
  constexpr int steps = 8;
  for (int step = 0; step <= steps; ++step) {
    const VectorXd dof = from + (to - from) * (static_cast<double>(step) / steps);
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
  // Turning about the axis of what is round or square is nothing new.
  if (shape.kind == model::ShapeKind::box && shape.size.x() != shape.size.y()) {
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

bool is_from_above(const Pose& X_OG) {
  return X_OG.linear()(2, 2) <= -0.7;
}

bool clears_table(const model::HandModel& hand, const Body& object, const TableApproach& approach) {
  const Pose X_OB = approach.X_OG * hand.X_BG().inverse();
  return above_table(hand, X_OB, approach.preshape, approach.preshape,
                     -model::half_extents(object.shape).z());
}

Expected<TableGrasp> close_on_table(const model::HandModel& hand, const Body& object,
                                    const TableApproach& approach) {
  const Pose X_BO = hand.X_BG() * approach.X_OG.inverse();
  const double table = -model::half_extents(object.shape).z();
  const auto reaches_into_table = [&](const VectorXd& dof) {
    return !above_table(hand, X_BO.inverse(), approach.preshape, dof, table);
  };
  const auto refused = [&] { return fail("fingers would reach into the table", object.name); };
  if (!clears_table(hand, object, approach)) return refused();
  ClosingOptions options;
  options.volume = false;
  options.fixed_object = !fingers_move_as_one(hand);
  options.longest = max_closing;
  options.resting = approach.resting;
  const auto closed = close_hand(hand, object, X_BO, approach.preshape, options);
  if (!closed) return tl::unexpected(closed.error());
  if (reaches_into_table(closed->dof)) return refused();
  TableGrasp grasp;
  grasp.X_OG = approach.X_OG;
  grasp.open = approach.preshape;
  grasp.dof = hand.clamp(closed->dof);  // what pushes bends a joint a little past its end
  grasp.closing.resize(grasp.dof.size());
  for (std::size_t i = 0; i < hand.dofs().size(); ++i) {
    const bool rests = i < approach.resting.size() && approach.resting[i];
    grasp.closing[static_cast<Eigen::Index>(i)] = rests ? 0 : hand.dofs()[i].closing;
  }
  grasp.epsilon = closed->quality.epsilon;
  return grasp;
}

}  // namespace prehend::grasping
