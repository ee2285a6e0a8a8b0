#include "services/performer/core/rehearsal/candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/grasping/preshapes.hpp"
#include "common/model/placement.hpp"

namespace prehend::performer {

namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double same_place = 0.01, same_turn = 0.1;            // m, rad: no other grasp
constexpr double lower = 0.008;                                 // m, than a hand's reach says
constexpr std::array turns{0, 30, -30, 60, -60, 90, -90, 180};  // degrees about the object's axis

Pose turned(double degrees, const Pose& X_OG) {
  const AngleAxisd turn(degrees * std::numbers::pi / 180, Vector3d::UnitZ());
  return Pose(turn) * X_OG;
}

/// The same a little lower, for a grasp from above that is kept high by the table; none for others.
/// Reach speaks of the open hand; fingers that stand otherwise come down less.
std::optional<Pose> lowered(const model::HandModel& hand, const model::Shape& shape, Pose X_OG) {
  const double room =
      X_OG.translation().z() - (model::half_extents(shape).z() - hand.reach().engage);
  if (X_OG.linear().col(2).z() > -0.99 || room < lower) return std::nullopt;
  X_OG.translation().z() -= lower;
  return X_OG;
}

/// Where the grasp frame may come to lie, as the person took it first; each once.
std::vector<Pose> grasp_poses(const model::HandModel& hand, const model::Shape& shape,
                              const Pose& X_OG) {
  std::vector<Pose> found;
  const auto offer = [&](const Pose& wanted) {
    const auto made = model::nearest_grasp(shape, wanted, hand.reach());
    if (!made || std::any_of(found.begin(), found.end(), [&](const Pose& other) {
          return (other.translation() - made->translation()).norm() < same_place &&
                 angle_between(other.linear(), made->linear()) < same_turn;
        }))
      return;
    found.push_back(*made);
    if (const auto below = lowered(hand, shape, *made)) found.push_back(*below);
  };
  for (const double turn : turns) offer(turned(turn, X_OG));
  const Vector3d y = X_OG.linear().col(1);
  const Vector3d closing = Vector3d(y.x(), y.y(), 0).norm() > 1e-6
                               ? Vector3d(y.x(), y.y(), 0).normalized()
                               : Vector3d::UnitX().eval();
  const Pose above = make_pose(Vector3d::Zero(), model::grasp_axes(-Vector3d::UnitZ(), closing));
  for (const double turn : {0, 90, 45, -45}) offer(turned(turn, above));
  return found;
}

/// Closes as the planner has judged it: all fingers arrive together, and press on.
RobotGrasp as_planned(const model::HandModel& hand, const model::GraspCandidate& candidate) {
  RobotGrasp made{candidate.X_OR * hand.X_BG().inverse(), candidate.preshape,
                  VectorXd::Zero(candidate.dof.size()), true};
  for (Eigen::Index i = 0; i < made.closing.size(); ++i) {
    const double closing = candidate.closing[i];
    const double way = closing * (candidate.dof[i] - candidate.preshape[i]);
    made.closing[i] =
        closing * (std::max(0.0, way) + hand.dofs()[static_cast<std::size_t>(i)].squeeze);
  }
  return made;
}

}  // namespace

std::vector<RobotGrasp> planned_grasps(const model::HandModel& hand, const model::Shape& shape,
                                       const Pose& X_OG,
                                       const std::vector<model::GraspCandidate>& planned) {
  std::vector<model::GraspCandidate> found;
  for (const double turn : turns) {
    const Pose from = turned(turn, X_OG);
    std::vector<model::GraspCandidate> there;
    for (const model::GraspCandidate& candidate : planned) {
      there.push_back(model::turned_to(shape, candidate, from));
      const Pose& X = there.back().X_OR;
      if (std::any_of(found.begin(), found.end(), [&](const model::GraspCandidate& other) {
            return (other.X_OR.translation() - X.translation()).norm() < same_place &&
                   angle_between(other.X_OR.linear(), X.linear()) < same_turn;
          }))
        there.pop_back();
    }
    std::stable_sort(there.begin(), there.end(), [&](const auto& a, const auto& b) {
      return angle_between(a.X_OG.linear(), from.linear()) <
             angle_between(b.X_OG.linear(), from.linear());
    });
    found.insert(found.end(), there.begin(), there.end());
  }
  std::vector<RobotGrasp> made;
  for (const model::GraspCandidate& candidate : found) made.push_back(as_planned(hand, candidate));
  return made;
}

std::vector<RobotGrasp> grasp_candidates(const model::HandModel& hand, const model::Shape& shape,
                                         const Pose& X_OG) {
  const std::vector<Pose> poses = grasp_poses(hand, shape, X_OG);
  const std::vector<VectorXd> preshapes = grasping::preshapes_of(hand);
  std::vector<RobotGrasp> made;
  // Along diagonals: what is likely in both respects first.
  for (std::size_t rank = 0; rank < poses.size() + preshapes.size(); ++rank)
    for (std::size_t k = 0; k < preshapes.size() && k <= rank; ++k)
      if (rank - k < poses.size())
        made.push_back({poses[rank - k] * hand.X_BG().inverse(), preshapes[k]});
  return made;
}

}  // namespace prehend::performer
