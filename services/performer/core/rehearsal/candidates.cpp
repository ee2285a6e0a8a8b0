#include "services/performer/core/rehearsal/candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/grasping/candidates.hpp"
#include "common/model/placement.hpp"

namespace prehend::performer {

namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double same_place = 0.01, same_turn = 0.1;  // m, rad: no other grasp
// Shares of its range by which a DoF that does not close is turned aside.
constexpr std::array turned_aside{1.0 / 12, 1.0 / 2, 1.0 / 3};
constexpr double same_preshape = 0.05;  // rad, or what stands for it (radian_of), of each DoF
constexpr double lower = 0.008;         // m, than a hand's reach says

Pose turned(double degrees, const Pose& X_OG) {
  const AngleAxisd turn(degrees * std::numbers::pi / 180, Vector3d::UnitZ());
  return Pose(turn) * X_OG;
}

/// What does not close, by this share of its range towards the limit that is farther away.
VectorXd aside(const model::HandModel& hand, VectorXd dof, double share) {
  for (Eigen::Index i = 0; i < dof.size(); ++i) {
    const model::HandDof& limits = hand.dofs()[static_cast<std::size_t>(i)];
    if (limits.closing != 0) continue;
    const double way = share * (limits.upper - limits.lower);
    dof[i] += limits.upper - dof[i] >= dof[i] - limits.lower ? way : -way;
  }
  return hand.clamp(dof);
}

bool alike(const model::HandModel& hand, const VectorXd& one, const VectorXd& other) {
  for (Eigen::Index i = 0; i < one.size(); ++i)
    if (std::abs(one[i] - other[i]) >
        same_preshape * model::radian_of(hand.dofs()[static_cast<std::size_t>(i)]))
      return false;
  return true;
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
  offer(X_OG);
  for (const double turn : {30, -30, 60, -60, 90, -90, 180}) offer(turned(turn, X_OG));
  const Vector3d y = X_OG.linear().col(1);
  const Vector3d closing = Vector3d(y.x(), y.y(), 0).norm() > 1e-6
                               ? Vector3d(y.x(), y.y(), 0).normalized()
                               : Vector3d::UnitX().eval();
  const Pose above = make_pose(Vector3d::Zero(), model::grasp_axes(-Vector3d::UnitZ(), closing));
  for (const double turn : {0, 90, 45, -45}) offer(turned(turn, above));
  return found;
}

}  // namespace

std::vector<VectorXd> preshapes_of(const model::HandModel& hand) {
  std::vector<VectorXd> made;
  const auto offer = [&](const VectorXd& dof) {
    if (std::none_of(made.begin(), made.end(),
                     [&](const VectorXd& other) { return alike(hand, dof, other); }))
      made.push_back(dof);
  };
  const VectorXd& open = hand.postures().at("open");
  offer(open);
  for (const double share : turned_aside) offer(aside(hand, open, share));
  for (const std::string& name : grasping::opened_postures(hand)) offer(hand.postures().at(name));
  return made;
}

std::vector<RobotGrasp> grasp_candidates(const model::HandModel& hand, const model::Shape& shape,
                                         const Pose& X_OG) {
  const std::vector<Pose> poses = grasp_poses(hand, shape, X_OG);
  const std::vector<VectorXd> preshapes = preshapes_of(hand);
  std::vector<RobotGrasp> made;
  // Along diagonals: what is likely in both respects first.
  for (std::size_t rank = 0; rank < poses.size() + preshapes.size(); ++rank)
    for (std::size_t k = 0; k < preshapes.size() && k <= rank; ++k)
      if (rank - k < poses.size())
        made.push_back({poses[rank - k] * hand.X_BG().inverse(), preshapes[k]});
  return made;
}

}  // namespace prehend::performer
