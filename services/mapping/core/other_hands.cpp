#include "services/mapping/core/other_hands.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace prehend::mapping {
namespace {

using Eigen::Vector3d;

constexpr double margin = 0.005;   // m, that is left between two hands
constexpr double step = 0.005;     // m, between two looks
constexpr int max_steps = 32;      // of one command
constexpr int max_pushes = 6;      // until there is room on all sides
constexpr double rounding = 1e-5;  // m

}  // namespace

void OtherHands::observe(const std::string& name, std::vector<Capsule> capsules) {
  if (capsules.empty()) return remove(name);
  Vector3d middle = Vector3d::Zero();
  for (const Capsule& one : capsules) middle += 0.5 * (one.a + one.b);
  middle /= static_cast<double>(capsules.size());
  double radius = 0;
  for (const Capsule& one : capsules)
    radius = std::max(
        {radius, (one.a - middle).norm() + one.radius, (one.b - middle).norm() + one.radius});
  others_[name] = {std::move(capsules), {middle, middle, radius}};
}

OtherHands::Gap OtherHands::gap(const std::vector<Capsule>& ours) const {
  Gap least{std::numeric_limits<double>::infinity(), Vector3d::UnitZ()};
  for (const auto& [name, other] : others_)
    for (const Capsule& one : ours) {
      if (distance(one, other.all) > std::min(least.distance, margin)) continue;
      for (const Capsule& it : other.capsules) {
        const Vector3d between = between_lines(one, it);
        const double length = between.norm(), d = length - one.radius - it.radius;
        if (d >= least.distance) continue;
        least.distance = d;
        if (length > 0) least.away = between / length;
      }
    }
  return least;
}

bool OtherHands::is_far(const Pose& before, double way) const {
  return std::all_of(others_.begin(), others_.end(), [&](const auto& entry) {
    const Capsule& all = entry.second.all;
    return (before.translation() - all.a).norm() > hand_.reach() + all.radius + way + margin;
  });
}

/// Two hands that are in each other come apart by this, whatever is nearest on the way.
bool OtherHands::leaves(const Pose& from, const Pose& to) const {
  return std::all_of(others_.begin(), others_.end(), [&](const auto& entry) {
    const Vector3d& middle = entry.second.all.a;
    return (to.translation() - middle).norm() > (from.translation() - middle).norm();
  });
}

Pose OtherHands::go(const Pose& before, const Pose& goal, const Eigen::VectorXd& dof) const {
  // What is farthest from the base goes farthest when it turns.
  const double way = (goal.translation() - before.translation()).norm() +
                     hand_.reach() * angle_between(before.linear(), goal.linear());
  if (is_far(before, way)) return goal;
  const int steps = std::clamp(static_cast<int>(std::ceil(way / step)), 1, max_steps);
  const double due = std::min(margin, gap(hand_.at(before, dof)).distance);
  Pose reached = before;
  Vector3d pushed = Vector3d::Zero();  // off the straight way
  for (int i = 1; i <= steps; ++i) {
    Pose next = i == steps ? goal : interpolate(before, goal, static_cast<double>(i) / steps);
    next.pretranslate(pushed);
    if (due < 0 && leaves(reached, next)) {
      reached = next;
      continue;
    }
    std::vector<Capsule> ours = hand_.at(next, dof);
    Gap left = gap(ours);
    for (int push = 0; push < max_pushes && left.distance < due; ++push) {
      // A little further than it must: else it would come nearer with each command.
      const Vector3d by = (due + rounding - left.distance) * left.away;
      pushed += by;
      next.pretranslate(by);
      for (Capsule& one : ours) {
        one.a += by;
        one.b += by;
      }
      left = gap(ours);
    }
    if (left.distance < due) break;
    reached = next;
  }
  return reached;
}

}  // namespace prehend::mapping
