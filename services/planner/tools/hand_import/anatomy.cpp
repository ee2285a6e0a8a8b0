#include "services/planner/tools/hand_import/anatomy.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "services/planner/tools/hand_import/closing.hpp"
#include "services/planner/tools/hand_import/grasp_frame.hpp"
#include "services/planner/tools/hand_import/hand_toml.hpp"
#include "services/planner/tools/hand_import/opposition.hpp"
#include "services/planner/tools/hand_import/skeleton.hpp"

namespace prehend::planner {
namespace {

using model::HandModel;

/// A hand.toml that only lets the URDF be loaded: a DoF a leading joint, fingertips wherever.
std::string provisional_toml(const Robot& robot, const std::vector<std::string>& leaders) {
  std::string text =
      "name = \"hand\"\n[grasp_frame]\nposition = [0, 0, 0]\n"
      "orientation = [1, 0, 0, 0]\n[materials]\ndefault = \"rubber\"\n";
  std::string open;
  for (const std::string& joint : leaders) {
    text += fmt::format("[[dof]]\nname = {0}\njoint = {0}\n", toml_text(joint));
    const JointLimit& limit = *robot.find_joint(joint)->limit;
    open += fmt::format("{}{:.17g}", open.empty() ? "" : ", ",
                        std::clamp(0.0, limit.lower, limit.upper));
  }
  return text + fmt::format(
                    "[[fingertip]]\nname = \"tip\"\nlink = {}\nposition = [0, 0, 0]\n"
                    "[postures]\nopen = [{}]\n",
                    toml_text(robot.links[0].name), open);
}

/// The fingers as the search for an opposition wants to know them.
Fingers fingers_of(const Skeleton& skeleton, const std::vector<Anatomy::Dof>& dofs) {
  Fingers known;
  known.open = known.fist = skeleton.rest();
  for (std::size_t i = 0; i < dofs.size(); ++i) {
    known.open[static_cast<Eigen::Index>(i)] = dofs[i].open;
    known.fist[static_cast<Eigen::Index>(i)] = dofs[i].fist;
    known.fixed.push_back(dofs[i].wrist);
  }
  for (const FingerChain& finger : skeleton.fingers()) {
    known.last.push_back(finger.leaf);
    known.p_LT.push_back(finger.p_LT);
  }
  return known;
}

/// What was found is said of the hand.
Anatomy with(const Skeleton& skeleton, Anatomy anatomy, const Opposition& best) {
  if (best.opening < 0.01) return anatomy;
  anatomy.X_BG = best.X_BG;
  anatomy.reach.opening = best.opening;
  anatomy.reach.engage = std::clamp(best.depth - 0.004, 0.005, 0.05);
  anatomy.preshapes = best.preshapes;
  if (best.alone >= 0)
    for (const int i : skeleton.fingers()[at(best.alone)].joints)
      anatomy.thumb_joints.push_back(skeleton.joint(i).name);
  for (std::size_t i = 0; i < anatomy.dofs.size(); ++i)
    anatomy.dofs[i].open = best.open[static_cast<Eigen::Index>(i)];
  find_clearance(skeleton, anatomy.dofs, anatomy.X_BG, anatomy.reach);
  return anatomy;
}

/// What the fingers can really hold, and from which posture.
Anatomy with_opposition(const Skeleton& skeleton, const Anatomy& anatomy,
                        const SearchEffort& effort, const AnatomyJudge& judge) {
  std::vector<int> closing;
  for (const Anatomy::Dof& dof : anatomy.dofs) closing.push_back(dof.closing);
  const Fingers known = fingers_of(skeleton, anatomy.dofs);
  const ContactWorld world(skeleton.hand(), closing, known.last);
  OppositionJudge asked;
  if (judge)
    asked = [&](const Opposition& opposition, double needed) {
      return judge(with(skeleton, anatomy, opposition), needed);
    };
  return with(skeleton, anatomy, find_opposition(world, known, anatomy.X_BG, effort, asked));
}

}  // namespace

Expected<Anatomy> find_anatomy(const Robot& robot, const SearchEffort& effort,
                               const AnatomyJudge& judge) {
  // DoFs in the order of the tree, as HandModel has its joints.
  std::vector<std::string> leaders;
  for (const RobotJoint& joint : robot.joints)
    if (!joint.mimic) leaders.push_back(joint.name);
  const auto hand =
      HandModel::parse(write_robot(robot, "provisional"), provisional_toml(robot, leaders));
  if (!hand) return tl::unexpected(hand.error());
  const Skeleton skeleton(*hand);
  if (skeleton.fingers().empty() || skeleton.fingers().size() > 32)
    return fail(fmt::format("{} fingertips found, not 1 to 32", skeleton.fingers().size()),
                "robot " + robot.name, "a finger is a chain of moving links that ends somewhere");
  Anatomy found;
  found.dofs = find_closing(skeleton);
  for (const FingerChain& finger : skeleton.fingers()) {
    const std::string& link = hand->links()[at(finger.leaf)].name;
    found.fingertips.push_back({link, link, finger.p_LT, {}});
    for (const int joint : finger.joints) {
      const int child = hand->joints()[at(joint)].child;
      if (const auto told = robot.human.find(hand->links()[at(child)].name);
          told != robot.human.end())
        found.fingertips.back().human = told->second;
    }
  }
  const GraspFrame frame = find_grasp_frame(skeleton, found.dofs);
  found.X_BG = frame.X_BG;
  found.reach = frame.reach;
  found.opposed = frame.opposed;
  return with_opposition(skeleton, found, effort, judge);
}

}  // namespace prehend::planner
