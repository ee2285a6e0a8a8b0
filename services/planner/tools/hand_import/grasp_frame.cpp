#include "services/planner/tools/hand_import/grasp_frame.hpp"

#include <algorithm>
#include <cmath>

#include "services/planner/tools/hand_import/closing.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;

/// The finger that the others oppose: whose motion while closing goes most against theirs; of
/// two, the second.
std::size_t find_thumb(const std::vector<Vector3d>& motion, const std::vector<Vector3d>& place) {
  const std::size_t n = motion.size();
  std::size_t thumb = n - 1;
  if (n < 3) return thumb;
  double best = 1e9;
  for (std::size_t i = 0; i < n; ++i) {
    Vector3d others = Vector3d::Zero(), middle = Vector3d::Zero();
    for (std::size_t k = 0; k < n; ++k)
      if (k != i) {
        others += motion[k];
        middle += place[k] / static_cast<double>(n - 1);
      }
    // Of equal opposition (fingers around a circle), the one that stands alone.
    const double alone = (place[i] - middle).norm();
    const double score = motion[i].normalized().dot(others.normalized()) - 5 * alone;
    if (score < best) {
      best = score;
      thumb = i;
    }
  }
  return thumb;
}

/// Thumb and fingers about to meet.
struct Meeting {
  Vector3d middle = Vector3d::Zero();    // between them
  Vector3d closing = Vector3d::UnitY();  // from thumb to fingers
  double share = 0;                      // of closing, at which they are there
  double widest = 0;                     // m, between them before
};

/// Of the grasp frame; at right angles.
struct Directions {
  Vector3d closing, approach;
};

class FrameFinder {
 public:
  FrameFinder(const Skeleton& skeleton, const std::vector<Anatomy::Dof>& dofs)
      : skeleton_(skeleton), dofs_(dofs) {}

  GraspFrame run() const {
    const auto open = tips(0), half = tips(0.5);
    std::vector<Vector3d> motion;
    for (std::size_t i = 0; i < open.size(); ++i) motion.push_back(half[i] - open[i]);
    const std::size_t thumb = find_thumb(motion, open);
    const Meeting meeting = find_meeting(thumb);
    GraspFrame frame = place(meeting, find_directions(thumb, meeting));
    frame.opposed = meeting.widest > 0.01 && open.size() > 1;
    return frame;
  }

 private:
  std::vector<Vector3d> tips(double share) const { return skeleton_.tips(closed_by(dofs_, share)); }

  /// The middle of all tips but the thumb's; of a single finger it is the palm's.
  Vector3d middle_of_others(const std::vector<Vector3d>& tips, std::size_t thumb) const {
    const std::size_t n = tips.size();
    Vector3d others = n == 1 ? skeleton_.p_BP() : Vector3d(Vector3d::Zero());
    for (std::size_t k = 0; k < n; ++k)
      if (k != thumb) others += tips[k] / static_cast<double>(n - 1);
    return others;
  }

  /// Where they have come as near as 5 cm, or as near as they do.
  Meeting find_meeting(std::size_t thumb) const {
    constexpr double wanted = 0.05;
    Meeting meeting;
    double nearest = 1e9;
    for (int i = 0; i <= 40 && nearest > wanted; ++i) {
      const std::vector<Vector3d> now = tips(i / 40.0);
      const Vector3d p = now[thumb], others = middle_of_others(now, thumb);
      const double gap = (others - p).norm();
      meeting.widest = std::max(meeting.widest, gap);
      if (gap < 0.005 || gap > nearest) continue;
      nearest = gap;
      meeting.middle = 0.5 * (others + p);
      meeting.closing = (others - p).normalized();
      meeting.share = i / 40.0;
    }
    return meeting;
  }

  /// Out of the palm is where thumb and fingers meet, where they move against each other. Beside
  /// fingers that the thumb does not move against, as in a human hand, it is where these begin to
  /// close.
  Directions find_directions(std::size_t thumb, const Meeting& meeting) const {
    const auto open = tips(0), begun = tips(0.1);
    const auto direction = [&](std::size_t i) {
      return Vector3d((begun[i] - open[i]).normalized());
    };
    Vector3d fingers = Vector3d::Zero();
    for (std::size_t i = 0; i < open.size(); ++i)
      if (i != thumb) fingers += direction(i);
    fingers.normalize();
    const bool like_human = open.size() >= 4 && direction(thumb).dot(fingers) > -0.6;
    const Vector3d approach =
        (like_human ? fingers : Vector3d(meeting.middle - skeleton_.p_BP())).normalized();
    const auto across = [](const Vector3d& v, const Vector3d& unit) {
      const Vector3d rest = v - v.dot(unit) * unit;
      return Vector3d(rest.norm() > 1e-3 * v.norm() ? rest : unit.unitOrthogonal()).normalized();
    };
    if (!like_human) return {meeting.closing, across(approach, meeting.closing)};
    return {across(meeting.closing, approach), approach};
  }

  /// A little nearer to the palm than where the tips meet, and what fits between.
  GraspFrame place(const Meeting& meeting, const Directions& directions) const {
    const Vector3d &closing = directions.closing, &approach = directions.approach;
    double surface = -1e9, width = 0.02;
    const Vector3d side = closing.cross(approach);
    for (const Vector3d& p : skeleton_.palm_points()) {
      surface = std::max(surface, approach.dot(p));
      width = std::max(width, std::abs(side.dot(p - meeting.middle)));
    }
    // How far the palm's surface is away below the tips' meeting point.
    const double depth = std::clamp(approach.dot(meeting.middle) - surface, 0.02, 0.2);
    const Vector3d origin = meeting.middle - 0.25 * depth * approach;
    double below = 0.01;
    for (double share = meeting.share; share <= 1; share += 0.1)
      for (const Vector3d& tip : tips(share)) below = std::max(below, approach.dot(tip - origin));
    GraspFrame frame;
    frame.X_BG = make_pose(origin, model::grasp_axes(approach, closing));
    frame.reach.opening = std::clamp(std::min(0.9 * meeting.widest, 1.6 * depth), 0.01, 0.25);
    frame.reach.engage = std::clamp(0.5 * depth, 0.01, 0.06);
    frame.reach.clearance = below + 0.01;
    frame.reach.half_width = std::min(width, 0.15) + 0.01;
    return frame;
  }

  const Skeleton& skeleton_;
  const std::vector<Anatomy::Dof>& dofs_;
};

}  // namespace

GraspFrame find_grasp_frame(const Skeleton& skeleton, const std::vector<Anatomy::Dof>& dofs) {
  return FrameFinder(skeleton, dofs).run();
}

void find_clearance(const Skeleton& skeleton, const std::vector<Anatomy::Dof>& dofs,
                    const Pose& X_BG, model::Reach& reach) {
  const Vector3d p = X_BG.translation(), out = X_BG.linear().col(2), side = X_BG.linear().col(0);
  double below = 0.01, width = 0.02;
  for (double share = 0; share <= 1; share += 0.1)
    for (const Vector3d& tip : skeleton.tips(closed_by(dofs, share)))
      below = std::max(below, out.dot(tip - p));
  for (const Vector3d& on_palm : skeleton.palm_points())
    width = std::max(width, std::abs(side.dot(on_palm - p)));
  reach.clearance = below + 0.01;
  reach.half_width = std::min(width, 0.15) + 0.01;
}

}  // namespace prehend::planner
