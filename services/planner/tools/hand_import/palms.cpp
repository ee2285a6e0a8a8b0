#include "services/planner/tools/hand_import/palms.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "services/planner/tools/hand_import/tree.hpp"

namespace prehend::planner {
namespace {

constexpr double apart = 0.25;   // m, between what branches: more is no part of one hand
constexpr int wrist_joints = 3;  // at most: more before a palm are an arm

/// Links that move as one, by the one nearest the root, and what moves against what.
class Bodies {
 public:
  Bodies(const Robot& robot, const std::string& root) {
    const Tree tree(robot);
    X_BL_ = tree.poses(root, rest_values(robot));
    std::map<std::string, std::string> body{{root, root}};
    for (const std::size_t i : tree.below(root)) {
      const RobotJoint& joint = robot.joints[i];
      body[joint.child] = joint.moves() ? joint.child : body[joint.parent];
      if (joint.moves()) moved_[body[joint.parent]].push_back(joint.child);
    }
  }

  /// Palms at this body or beyond; empty: fewer than two chains end there.
  std::vector<std::string> palms(std::string at) const {
    while (moved(at).size() == 1) at = moved(at)[0];
    if (moved(at).empty()) return {};
    std::vector<std::string> further;
    for (const std::string& child : moved(at))
      for (const std::string& palm : palms(child))
        if (distance(at, palm) > apart) further.push_back(palm);
    if (further.empty()) further.push_back(at);
    return further;
  }

 private:
  const std::vector<std::string>& moved(const std::string& body) const {
    static const std::vector<std::string> none;
    const auto found = moved_.find(body);
    return found == moved_.end() ? none : found->second;
  }
  double distance(const std::string& a, const std::string& b) const {
    return (X_BL_.at(a).translation() - X_BL_.at(b).translation()).norm();
  }

  std::map<std::string, Pose> X_BL_;
  std::map<std::string, std::vector<std::string>> moved_;
};

/// What hangs on a link, which becomes the root. Joints that followed others that are gone lead.
Robot part_below(const Robot& robot, const std::string& link) {
  Robot part{robot.name, {}, {}, robot.findings};
  std::set<std::string> links{link}, joints;
  for (const std::size_t i : Tree(robot).below(link)) {
    links.insert(robot.joints[i].child);
    joints.insert(robot.joints[i].name);
    part.joints.push_back(robot.joints[i]);
  }
  for (RobotJoint& joint : part.joints)
    if (joint.mimic && !joints.contains(joint.mimic->joint)) joint.mimic.reset();
  part.human = robot.human;
  std::erase_if(part.human, [&](const auto& one) { return !links.contains(one.first); });
  std::ranges::copy_if(robot.links, std::back_inserter(part.links),
                       [&](const RobotLink& one) { return links.contains(one.name); });
  return part;
}

/// Joints that lead and move, on the way from the root to a link.
int joints_before(const Robot& robot, const std::string& link) {
  int count = 0;
  std::string at = link;
  for (std::size_t steps = 0; steps < robot.joints.size(); ++steps) {
    const auto above = std::ranges::find(robot.joints, at, &RobotJoint::child);
    if (above == robot.joints.end()) break;
    count += above->moves() && !above->mimic;
    at = above->parent;
  }
  return count;
}

/// Shapes at the root that no hand has: a table, a floor, a box as large as the room.
void leave_world_out(Robot& robot) {
  const Tree tree(robot);
  if (tree.roots().size() != 1 || robot.links.size() < 2) return;
  const auto root = std::ranges::find(robot.links, tree.roots()[0], &RobotLink::name);
  const auto too_large = [](const Solid& solid) {
    return solid.mesh.empty() && is_valid(solid.shape) &&
           model::half_extents(solid.shape).maxCoeff() > 0.5 * hand_kind.max_link;
  };
  const std::size_t gone =
      std::erase_if(root->collision, too_large) + std::erase_if(root->visual, too_large);
  if (gone == 0) return;
  root->inertial.reset();
  robot.findings.push_back({Severity::warning, "world", "link " + root->name, root->line,
                            "has a shape that is larger than a hand",
                            "`add` takes it for the world and leaves it out"});
}

}  // namespace

std::vector<std::string> palms(const Robot& robot) {
  const Tree tree(robot);
  if (tree.roots().size() != 1) return {};
  const std::string& root = tree.roots()[0];
  const auto found = Bodies(robot, root).palms(root);
  return found.empty() ? std::vector{root} : found;
}

Robot hand_of(Robot robot, const std::string& palm) {
  leave_world_out(robot);
  const auto tell = [&robot](Severity severity, const char* code, std::string element,
                             std::string what, std::string repair) {
    robot.findings.push_back(
        {severity, code, std::move(element), 0, std::move(what), std::move(repair)});
  };
  if (!palm.empty() && !robot.find_link(palm)) {
    tell(Severity::error, "no-palm", "link " + palm, "is to be the palm and is not there",
         "name a link of this file");
    return robot;
  }
  const auto found = palms(robot);
  if (palm.empty() && found.size() > 1) {
    tell(Severity::error, "several-hands", "robot " + robot.name,
         fmt::format("has {} hands, whose palms are {}", found.size(), fmt::join(found, ", ")),
         "choose one: --palm " + found[0]);
    return robot;
  }
  if (palm.empty() && found.empty()) return robot;
  const std::string& chosen = palm.empty() ? found[0] : palm;
  const int before = joints_before(robot, chosen);
  if (palm.empty() && before <= wrist_joints) return robot;
  if (before > 0)
    tell(Severity::warning, "arm", "link " + chosen,
         fmt::format("is the palm, with {} joint{} before it", before, before == 1 ? "" : "s"),
         "`add` takes what hangs on it and leaves the rest out");
  return part_below(robot, chosen);
}

}  // namespace prehend::planner
