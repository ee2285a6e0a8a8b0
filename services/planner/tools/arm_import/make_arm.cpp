#include "services/planner/tools/arm_import/make_arm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "services/planner/tools/arm_import/arm_toml.hpp"
#include "services/planner/tools/arm_import/chain.hpp"
#include "services/planner/tools/hand_import/check.hpp"
#include "services/planner/tools/hand_import/repair.hpp"

namespace prehend::planner {
namespace {

void find_faults(const Robot& robot, const ArmChain& chain, std::vector<UrdfFinding>& findings) {
  const auto error = [&](const char* code, std::string element, int line, std::string what,
                         std::string repair) {
    findings.push_back(
        {Severity::error, code, std::move(element), line, std::move(what), std::move(repair)});
  };
  const std::size_t count = chain.moving.size();
  if (count < model::min_arm_joints || count > model::max_arm_joints)
    error("joint-count", "robot " + robot.name, 0,
          fmt::format("has {} joint{} on the way to link {}; an arm has 6 or 7", count,
                      count == 1 ? "" : "s", chain.tip),
          count > model::max_arm_joints ? "name the link at the arm's end: --tip LINK"
                                        : "use a robot with 6 or 7 joints that turn");
  for (const std::size_t i : chain.moving) {
    const RobotJoint& joint = robot.joints[i];
    if (joint.slides())
      error("slides", "joint " + joint.name, joint.line, "slides; the joints of an arm turn",
            "name the link at the arm's end: --tip LINK, or use another robot");
    if (joint.mimic)
      error("coupled", "joint " + joint.name, joint.line, "follows another joint",
            "joints of an arm move alone: leave <mimic> out");
  }
}

/// Is it about how a joint beside the arm moves? That one is fixed.
bool is_of_the_still(const UrdfFinding& finding, const Robot& robot, const ArmChain& chain) {
  constexpr std::array codes{"no-limits",  "zero-axis", "mimic-missing", "mimic-loop",
                             "mimic-zero", "no-effort", "no-velocity",   "continuous"};
  return std::find(codes.begin(), codes.end(), finding.code) != codes.end() &&
         std::any_of(chain.beside.begin(), chain.beside.end(), [&](std::size_t i) {
           return finding.element == "joint " + robot.joints[i].name;
         });
}

/// The robot with the joints beside the chain fixed.
Robot without_others(const Robot& robot, const ArmChain& chain, std::vector<std::string>& changes) {
  Robot still = robot;
  for (const std::size_t i : chain.beside) {
    RobotJoint& joint = still.joints[i];
    joint.type = "fixed";
    joint.mimic.reset();
    changes.push_back(fmt::format("joint {}: beside the arm, fixed at 0", joint.name));
  }
  return still;
}

}  // namespace

std::vector<UrdfFinding> check_arm(const Robot& robot, const MeshReader& meshes,
                                   const std::string& tip) {
  auto findings = check(robot, meshes, arm_kind);
  const bool tree = std::none_of(findings.begin(), findings.end(), [](const UrdfFinding& f) {
    return f.code == "no-links" || f.code == "two-parents" || f.code == "joint-loop" ||
           f.code == "several-roots" || f.code == "no-fingertips" || f.code == "missing-link" ||
           f.code == "duplicate-name" || f.code == "no-name";
  });
  std::erase_if(findings, [](const UrdfFinding& f) { return f.code == "self-collision"; });
  for (UrdfFinding& finding : findings)
    if (finding.code == "no-fingertips") {
      finding.code = "joint-count";
      finding.what = "no joint moves; an arm has 6 or 7 that turn";
      finding.repair = "use the URDF of an arm";
    }
  if (!tree) return findings;
  const auto chain = find_chain(robot, tip);
  if (!chain) {
    findings.insert(findings.begin(), {Severity::error, "no-tip", "robot " + robot.name, 0,
                                       chain.error().what, chain.error().hint});
    return findings;
  }
  std::erase_if(findings, [&](const UrdfFinding& f) { return is_of_the_still(f, robot, *chain); });
  std::vector<UrdfFinding> faults;
  find_faults(robot, *chain, faults);
  findings.insert(findings.begin(), faults.begin(), faults.end());
  return findings;
}

Expected<MadeArm> make_arm(const Robot& robot, const std::string& name, const MeshReader& meshes,
                           const std::string& tip) {
  const auto findings = check_arm(robot, meshes, tip);
  if (!is_usable(findings)) {
    const UrdfFinding& first = findings.front();
    return fail(
        first.what,
        first.line > 0 ? fmt::format("line {}: {}", first.line, first.element) : first.element,
        first.repair);
  }
  const auto chain = find_chain(robot, tip);
  if (!chain) return tl::unexpected(chain.error());
  MadeArm made;
  auto mended = repair(without_others(robot, *chain, made.changes), meshes, arm_kind);
  if (!mended) return tl::unexpected(mended.error());
  mended->robot.name = name;
  made.changes.insert(made.changes.end(), mended->changes.begin(), mended->changes.end());
  made.urdf = write_robot(mended->robot, "Made by `prehend arm add`.");
  // First as it is, then with what only an arm that moves can show.
  ArmText text{name, chain->X_LE, {}, {}};
  const auto bare = model::ArmModel::parse(made.urdf, write_toml(text));
  if (!bare) return tl::unexpected(bare.error());
  text.not_checked = always_touching(*bare);
  for (const auto& [a, b] : text.not_checked)
    made.changes.push_back(
        fmt::format("links {} and {}: their shapes always touch, so nobody checks them", a, b));
  const auto checked = model::ArmModel::parse(made.urdf, write_toml(text));
  if (!checked) return tl::unexpected(checked.error());
  text.home = nimble_posture(*checked);
  made.toml = write_toml(text);
  auto model = model::ArmModel::parse(made.urdf, made.toml);
  if (!model) return tl::unexpected(model.error());
  made.model = std::move(*model);
  return made;
}

}  // namespace prehend::planner
