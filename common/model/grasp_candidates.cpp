#include "common/model/grasp_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace prehend::model {
namespace {

constexpr double farthest = 0.03, max_turn = 0.35;  // m, rad: as far as a placement may correct
constexpr double sure_enough = 0.6;                 // room, below which the network answers
constexpr double same_approach = 0.2;               // rad
constexpr double other_size = 0.01;                 // m, and as a share:
constexpr double other_share = 0.25;
constexpr double end_tolerance = 1e-6;  // rad or m
constexpr std::size_t max_known = 1000;

Expected<void> check(const GraspCandidate& candidate, const HandModel& hand) {
  const auto dofs = static_cast<Eigen::Index>(hand.dofs().size());
  for (const Eigen::VectorXd* values : {&candidate.preshape, &candidate.dof, &candidate.closing})
    if (values->size() != dofs || !values->allFinite())
      return fail("grasp candidate of another hand");
  for (const Eigen::VectorXd* values : {&candidate.preshape, &candidate.dof})
    if ((hand.clamp(*values) - *values).cwiseAbs().maxCoeff() > end_tolerance)
      return fail("grasp candidate beyond the hand's limits");
  if (!is_finite(candidate.X_OG) || !is_finite(candidate.X_OR) || !(candidate.room >= 0))
    return fail("grasp candidate not finite");
  if (!(candidate.follow_through >= 0) || candidate.follow_through > full_follow_through)
    return fail("grasp candidate follows through too far");
  const Pose off = candidate.X_OG.inverse() * candidate.X_OR;
  if (!(off.translation().norm() <= farthest) ||
      !(angle_between(off.linear(), Eigen::Matrix3d::Identity().eval()) <= max_turn))
    return fail("grasp candidate away from its approach");
  return {};
}

/// Turns about z after which the object looks the same: the one that brings R_from nearest to R_to.
Eigen::Matrix3d turn_to(const Shape& shape, const Eigen::Matrix3d& R_from,
                        const Eigen::Matrix3d& R_to) {
  const Eigen::Matrix3d R = R_to * R_from.transpose();
  double angle = std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
  if (shape.kind == ShapeKind::box) {
    const bool square = std::abs(shape.size.x() - shape.size.y()) < 1e-3;
    const double step = square ? std::numbers::pi / 2 : std::numbers::pi;
    angle = step * std::round(angle / step);
  }
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

/// By the trace, which tells the cosine of the angle between both.
bool is_same_approach(const Eigen::Matrix3d& R_a, const Eigen::Matrix3d& R_b) {
  static const double min_trace = 1 + 2 * std::cos(same_approach);
  return R_a.cwiseProduct(R_b).sum() >= min_trace;
}

GraspCandidate turned(const GraspCandidate& candidate, const Eigen::Matrix3d& turn) {
  GraspCandidate made = candidate;
  const Pose X = make_pose(Eigen::Vector3d::Zero(), turn);
  made.X_OG = X * candidate.X_OG;
  made.X_OR = X * candidate.X_OR;
  return made;
}

bool is_like(const Shape& a, const Shape& b) {
  return a.kind == b.kind &&
         ((a.size - b.size).array().abs() <= (other_share * a.size.array()).max(other_size)).all();
}

}  // namespace

GraspCandidate turned_to(const Shape& shape, const GraspCandidate& candidate, const Pose& X_OG) {
  return turned(candidate, turn_to(shape, candidate.X_OG.linear(), X_OG.linear()));
}

Expected<void> CandidateBook::observe(GraspCandidates planned, const HandModel& hand) {
  for (const GraspCandidate& candidate : planned.candidates)
    if (auto ok = check(candidate, hand); !ok) return ok;
  if (!known_.contains(planned.track) && known_.size() >= max_known)
    return fail("grasp candidates of too many objects");
  known_[planned.track] = std::move(planned);
  return {};
}

std::optional<GraspCandidate> CandidateBook::answer(std::uint32_t track, const Shape& shape,
                                                    const Pose& X_OG) const {
  const auto known = known_.find(track);
  if (known == known_.end() || !is_like(known->second.shape, shape)) return std::nullopt;
  // Asked of every object in every frame: only what answers is copied.
  const GraspCandidate* best = nullptr;
  Eigen::Matrix3d best_turn;
  for (const GraspCandidate& candidate : known->second.candidates) {
    if (candidate.room < sure_enough || (best && best->room >= candidate.room)) continue;
    const Eigen::Matrix3d turn = turn_to(shape, candidate.X_OG.linear(), X_OG.linear());
    if (!is_same_approach(turn * candidate.X_OG.linear(), X_OG.linear())) continue;
    best = &candidate;
    best_turn = turn;
  }
  if (!best) return std::nullopt;
  return turned(*best, best_turn);
}

std::vector<GraspCandidate> CandidateBook::of(std::string_view object, const Shape& shape) const {
  std::vector<GraspCandidate> sure;
  for (const auto& [track, planned] : known_) {
    if (planned.object != object || !is_like(planned.shape, shape)) continue;
    for (const GraspCandidate& candidate : planned.candidates)
      if (candidate.room >= sure_enough) sure.push_back(candidate);
    if (!sure.empty()) break;
  }
  return sure;
}

}  // namespace prehend::model
