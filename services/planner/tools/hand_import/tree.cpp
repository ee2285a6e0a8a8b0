#include "services/planner/tools/hand_import/tree.hpp"

#include <algorithm>

namespace prehend::planner {

Tree::Tree(const Robot& robot) : robot_(robot) {
  std::set<std::string> children;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    children_.emplace(robot.joints[i].parent, i);
    children.insert(robot.joints[i].child);
  }
  for (const RobotLink& link : robot.links)
    if (!children.contains(link.name)) roots_.push_back(link.name);
}

std::vector<std::size_t> Tree::below(const std::string& link) const {
  std::vector<std::size_t> joints;
  std::set<std::string> seen{link};
  std::vector<std::string> open{link};
  while (!open.empty()) {
    const std::string at = open.back();
    open.pop_back();
    const auto [begin, end] = children_.equal_range(at);
    std::vector<std::string> next;
    for (auto it = begin; it != end; ++it) {
      const std::string& child = robot_.joints[it->second].child;
      if (!seen.insert(child).second) continue;
      joints.push_back(it->second);
      next.push_back(child);
    }
    open.insert(open.end(), next.rbegin(), next.rend());
  }
  return joints;
}

std::map<std::string, Pose> Tree::poses(const std::string& root,
                                        const std::vector<double>& values) const {
  std::map<std::string, Pose> X_BL{{root, Pose::Identity()}};
  for (const std::size_t i : below(root)) {
    const RobotJoint& joint = robot_.joints[i];
    Pose X = X_BL[joint.parent] * joint.X_PJ;
    const double length = joint.axis_J.norm();
    if (joint.moves() && length > 1e-9) {
      const Eigen::Vector3d axis = joint.axis_J / length;
      if (joint.slides())
        X.translate(values[i] * axis);
      else
        X.rotate(Eigen::AngleAxisd(values[i], axis));
    }
    X_BL[joint.child] = X;
  }
  return X_BL;
}

std::optional<Leader> leader_of(const Robot& robot, std::size_t joint) {
  Leader leader{joint, 1, 0};
  for (std::size_t steps = 0; steps <= robot.joints.size(); ++steps) {
    const auto& mimic = robot.joints[leader.joint].mimic;
    if (!mimic) return leader;
    const auto next = std::find_if(robot.joints.begin(), robot.joints.end(),
                                   [&](const auto& other) { return other.name == mimic->joint; });
    if (next == robot.joints.end()) return std::nullopt;
    leader.offset += leader.multiplier * mimic->offset;
    leader.multiplier *= mimic->multiplier;
    leader.joint = static_cast<std::size_t>(next - robot.joints.begin());
  }
  return std::nullopt;
}

std::optional<std::pair<double, double>> followed_range(const Robot& robot, std::size_t joint) {
  const auto leader = leader_of(robot, joint);
  if (!leader || leader->joint == joint) return std::nullopt;
  const auto& limit = robot.joints[leader->joint].limit;
  if (!limit || !limit->has_range || limit->lower > limit->upper) return std::nullopt;
  const double a = leader->multiplier * limit->lower + leader->offset,
               b = leader->multiplier * limit->upper + leader->offset;
  return std::minmax(a, b);
}

std::vector<double> rest_values(const Robot& robot) {
  std::vector<double> values(robot.joints.size(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto leader = leader_of(robot, i);
    if (!leader) continue;
    const auto& limit = robot.joints[leader->joint].limit;
    double rest = 0;
    if (limit && limit->lower <= limit->upper) rest = std::clamp(0.0, limit->lower, limit->upper);
    values[i] = leader->multiplier * rest + leader->offset;
  }
  return values;
}

}  // namespace prehend::planner
