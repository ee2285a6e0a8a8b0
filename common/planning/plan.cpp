#include "common/planning/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/arm/inverse.hpp"

namespace prehend::planning {
namespace {

using arm::Joints;

constexpr double look_m = 0.01, look_rad = 0.05;  // along a straight way
constexpr int looks_at_branch = 100;
constexpr double near_branch = 0.5;  // of the least dexterity: a way may lead round
constexpr double max_turn = 0.5;     // rad, of a joint between two looks
constexpr double apart = 0.03;       // m, of the corners of a path
constexpr int gentle = 6;            // corners, over which a bend is spread

/// Does the straight way between two postures keep off singularities, whatever else is there? If
/// not, they are on different branches of the inverse kinematics, or nearly so.
bool is_same_branch(const Room& room, const Joints& a, const Joints& b, double min_dexterity) {
  for (int k = 1; k < looks_at_branch; ++k)
    if (room.dexterity(a + static_cast<double>(k) / looks_at_branch * (b - a)) < min_dexterity)
      return false;
  return true;
}

/// Can the arm go on straight, from pose to pose? Empty, or why not.
std::string trouble_after(const Robot& robot, const Room& contact, const Query& query, Joints q) {
  for (const Pose& X_WB : query.then) {
    const auto path = straight_way(robot, contact, q, X_WB);
    if (!path) return path.error().what;
    q = path->back();
  }
  return {};
}

/// Postures that put the hand there and are free, or why there are none.
Expected<std::vector<Joints>> goals_of(const Robot& robot, const Query& query,
                                       const PlanOptions& options, const Ground& ground,
                                       const Room& room) {
  Scene bare = query.scene;
  bare.held.reset();
  RoomOptions near = options.room;
  near.hand_clearance = options.contact_clearance;
  near.clearance = std::min(near.clearance, options.arm_contact_clearance);
  near.touched = query.touched;
  const Room contact(robot, bare, near);
  std::vector<Joints> goals;
  std::string why = "is out of the arm's reach";
  int known = 0;  // how much the reason says
  const auto because = [&](int rank, const std::string& reason) {
    if (rank > known) why = reason;
    known = std::max(known, rank);
  };
  for (const Joints& branch : arm::Inverse(*robot.arm).branches(robot.end_for(query.X_WB)))
    for (const Joints& q : arm::turns_within_limits(*robot.arm, branch)) {
      if (!is_same_branch(room, query.start, q, near_branch * options.room.min_dexterity))
        because(1, "needs another branch than the arm is in");
      else if (!ground.is_free(q))
        because(2, "is not free: " + (room.trouble(q).empty() ? "not upright" : room.trouble(q)));
      else if (const std::string after = trouble_after(robot, contact, query, q); !after.empty())
        because(3, after);
      else
        goals.push_back(q);
    }
  if (goals.empty()) return fail(why, "where the hand shall go");
  return goals;
}

}  // namespace

Expected<Path> straight_way(const Robot& robot, const Room& room, const Joints& from,
                            const Pose& X_WB) {
  const Pose begin = robot.hand_at(from);
  const double far = (X_WB.translation() - begin.translation()).norm();
  const double turn = angle_between(X_WB.linear(), begin.linear());
  const int looks =
      std::max(1, static_cast<int>(std::ceil(std::max(far / look_m, turn / look_rad))));
  Path path{from};
  for (int k = 1; k <= looks; ++k) {
    const double share = static_cast<double>(k) / looks;
    const auto stop = [&](const std::string& why) {
      return fail(fmt::format("after {:.0f} of {:.0f} cm straight on: {}", 100 * share * far,
                              100 * far, why));
    };
    const auto q =
        arm::refine(*robot.arm, robot.end_for(interpolate(begin, X_WB, share)), path.back());
    if (!q) return stop("out of reach");
    if ((*q - path.back()).cwiseAbs().maxCoeff() > max_turn) return stop("the arm would turn over");
    if (!room.is_free(path.back(), *q)) {
      const std::string why = room.trouble(*q);
      return stop(why.empty() ? "something is in the way" : why);
    }
    path.push_back(*q);
  }
  return path;
}

Expected<Trajectory> plan(const Robot& robot, const Query& query, const PlanOptions& options) {
  if (query.start.size() != static_cast<Eigen::Index>(robot.arm->joints.size()) ||
      !query.start.allFinite() || !is_finite(query.X_WB))
    return fail("not usable", "start or goal of the arm");
  Room room(robot, query.scene, options.room);
  if (const auto found = room.conflict(query.start); found && found->distance <= 0)
    return fail("begins in a collision: " + found->message(), robot.arm->name,
                "lead the hand away first");
  room.tolerate(query.start);
  const Ground ground(robot, room, query.upright);
  if (!ground.is_free(query.start)) {
    const std::string why = room.trouble(query.start);
    return fail("cannot begin: " + (why.empty() ? "not upright" : why), robot.arm->name,
                "lead the hand elsewhere first");
  }
  const auto goals = goals_of(robot, query, options, ground, room);
  if (!goals) return tl::unexpected(goals.error());
  const auto path = search(*robot.arm, ground, query.start, *goals, options.search);
  if (!path)
    return fail(fmt::format("no way found in {} tries", options.search.max_iterations),
                robot.arm->name, "make room, or begin elsewhere");
  const Path even = evened(ground, *path, apart);
  return timed(robot, rounded(ground, even, gentle), options.pace);
}

}  // namespace prehend::planning
