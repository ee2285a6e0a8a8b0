#include "services/ros/core/trajectory_follower.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "common/base/printable.hpp"
#include "common/base/time_between.hpp"

namespace prehend::ros {
namespace {

constexpr Duration max_away = std::chrono::seconds(10);  // of a stamp
constexpr double tolerated_outside = 0.01;  // of a DoF's range: rounded; the gate cuts it
constexpr std::size_t max_name = 64;        // of somebody else's name, in a message

}  // namespace

Expected<TrajectoryFollower::Order> TrajectoryFollower::order_of(
    const std::vector<std::string>& names) const {
  Order order;
  std::vector<bool> known(names.size());
  for (const model::HandDof& dof : hand_.dofs()) {
    const std::string& joint = hand_.joints()[static_cast<std::size_t>(dof.joint)].name;
    const auto found = std::find(names.begin(), names.end(), joint);
    if (found == names.end()) return fail("does not name the joint " + joint);
    order.push_back(found - names.begin());
    known[static_cast<std::size_t>(order.back())] = true;
  }
  const auto unknown = std::find(known.begin(), known.end(), false);
  if (unknown == known.end()) return order;
  const std::string& name = names[static_cast<std::size_t>(unknown - known.begin())];
  return fail(fmt::format("names «{}», a joint that leads no DoF of {}",
                          printable(name.substr(0, max_name)), hand_.name()));
}

Expected<Eigen::VectorXd> TrajectoryFollower::dof_of(const std::vector<double>& positions,
                                                     const Order& order) const {
  Eigen::VectorXd made(static_cast<Eigen::Index>(order.size()));
  for (std::size_t d = 0; d < order.size(); ++d) {
    const model::HandDof& dof = hand_.dofs()[d];
    const double at = positions[static_cast<std::size_t>(order[d])];
    const double slack = tolerated_outside * (dof.upper - dof.lower);
    if (at < dof.lower - slack || at > dof.upper + slack)
      return fail(fmt::format("has {} at {:.4g}, outside its range {:.4g} to {:.4g}",
                              hand_.joints()[static_cast<std::size_t>(dof.joint)].name, at,
                              dof.lower, dof.upper));
    made[static_cast<Eigen::Index>(d)] = at;
  }
  return made;
}

Expected<void> TrajectoryFollower::take(const ros2::JointTrajectory& trajectory,
                                        const Eigen::VectorXd& here, Time now) {
  if (trajectory.points.empty()) {
    stop();
    return {};
  }
  const auto order = order_of(trajectory.names);
  if (!order) return tl::unexpected(order.error());
  const bool at_once = trajectory.stamp_ns == 0;
  const Time begin = at_once ? now : from_ns(trajectory.stamp_ns);
  if (!is_within(begin, now, max_away))
    return fail(fmt::format("has a stamp {:.1f} s away from now", to_seconds(between(begin, now))),
                {}, "do both sides have the same clock?");
  if (!at_once && begin + trajectory.points.back().time_from_start <= now)
    return fail("is over already");
  std::vector<Knot> knots{{now, goal(now).value_or(hand_.clamp(here))}};
  for (const auto& point : trajectory.points) {
    auto dof = dof_of(point.positions, *order);
    if (!dof) return tl::unexpected(dof.error());
    // What has passed is not made up for.
    const Time at = begin + point.time_from_start;
    if (at > now)
      knots.push_back({at, std::move(*dof)});
    else if (&point == &trajectory.points.back())
      knots.push_back({now, std::move(*dof)});
  }
  knots_ = std::move(knots);
  return {};
}

std::optional<Eigen::VectorXd> TrajectoryFollower::goal(Time now) const {
  if (knots_.empty()) return std::nullopt;
  const auto next = std::upper_bound(knots_.begin(), knots_.end(), now,
                                     [](Time t, const Knot& knot) { return t < knot.at; });
  if (next == knots_.begin()) return next->dof;
  const Knot& last = *std::prev(next);
  if (next == knots_.end()) return last.dof;
  const double share = to_seconds(now - last.at) / to_seconds(next->at - last.at);
  return last.dof + share * (next->dof - last.dof);
}

}  // namespace prehend::ros
