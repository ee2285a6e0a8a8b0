#include "services/planner/tools/arm_import/chain.hpp"

#include <algorithm>
#include <map>

namespace prehend::planner {
namespace {

/// How a link hangs on the root.
struct Way {
  std::vector<std::size_t> joints;  // all, fixed ones too
  std::size_t moving = 0;
};

std::map<std::string, Way> ways(const Robot& robot, const Tree& tree) {
  const std::string& root = tree.roots().front();
  std::map<std::string, Way> found{{root, {}}};
  for (const std::size_t i : tree.below(root)) {
    const RobotJoint& joint = robot.joints[i];
    Way way = found[joint.parent];
    way.joints.push_back(i);
    way.moving += joint.moves() ? 1 : 0;
    found[joint.child] = std::move(way);
  }
  return found;
}

}  // namespace

Expected<ArmChain> find_chain(const Robot& robot, const std::string& tip) {
  const Tree tree(robot);
  const auto all = ways(robot, tree);
  ArmChain chain;
  chain.tip = tip;
  if (tip.empty()) {
    // Of links with as many joints the one with the most fixed ones: tool frames hang at the end.
    std::pair<std::size_t, std::size_t> longest{0, 0};
    for (const RobotLink& link : robot.links) {
      const Way& way = all.at(link.name);
      const std::pair length(way.moving, way.joints.size());
      if (!chain.tip.empty() && length <= longest) continue;
      longest = length;
      chain.tip = link.name;
    }
  }
  const auto found = all.find(chain.tip);
  if (found == all.end())
    return fail("there is no link " + tip, {}, "--tip names a link of the URDF");
  for (const std::size_t i : found->second.joints) {
    const RobotJoint& joint = robot.joints[i];
    if (joint.moves()) {
      chain.moving.push_back(i);
      chain.X_LE = Pose::Identity();
    } else {
      chain.X_LE = chain.X_LE * joint.X_PJ;
    }
  }
  for (std::size_t i = 0; i < robot.joints.size(); ++i)
    if (robot.joints[i].moves() &&
        std::find(chain.moving.begin(), chain.moving.end(), i) == chain.moving.end())
      chain.beside.push_back(i);
  return chain;
}

}  // namespace prehend::planner
