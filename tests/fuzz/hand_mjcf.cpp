// Damaged MJCF through `prehend hand check` and `prehend hand add`: findings that say where and
// what, and if a hand is made of it, a sound one with every collision shape of the file in it.
#include <console_bridge/console.h>

#include <numeric>

#include "services/planner/tools/hand_import/make_hand.hpp"
#include "services/planner/tools/hand_import/mjcf.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/hand_files.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/support/mjcf/mjcf_text.hpp"

using namespace prehend;

namespace {

std::size_t solids_of(const planner::Robot& robot) {
  return std::accumulate(
      robot.links.begin(), robot.links.end(), std::size_t{0},
      [](std::size_t sum, const auto& link) { return sum + link.collision.size(); });
}

void require_finite(const planner::Robot& robot) {
  for (const planner::RobotJoint& joint : robot.joints) {
    fuzz::require(is_finite(joint.X_PJ) && joint.axis_J.allFinite(), "a joint is not finite");
    if (joint.mimic)
      fuzz::require(joint.mimic->multiplier != 0 && std::isfinite(joint.mimic->multiplier) &&
                        std::isfinite(joint.mimic->offset) && robot.find_joint(joint.mimic->joint),
                    "a joint follows by no number, or nobody");
  }
  for (const planner::RobotLink& link : robot.links)
    for (const planner::Solid& solid : link.collision)
      fuzz::require(is_finite(solid.X_LS) && (!solid.mesh.empty() || is_valid(solid.shape)),
                    "a shape is not valid");
}

bool make(const std::string& text) {
  const auto again = [&](const std::string& name) -> Expected<std::string> {
    if (name.size() % 2 == 0) return text;  // a file may include itself
    return fail("is not there");
  };
  const auto robot = planner::read_mjcf(text, again);
  if (!robot) {
    fuzz::require(!robot.error().what.empty(), "refused without a reason");
    return false;
  }
  require_finite(*robot);
  const auto block = [](const planner::Solid&) -> Expected<std::vector<Eigen::Vector3d>> {
    return std::vector<Eigen::Vector3d>{{0, 0, 0}, {0.02, 0.03, 0.04}};
  };
  for (const planner::UrdfFinding& finding : planner::check(*robot, block))
    fuzz::require(!finding.what.empty() && !finding.repair.empty() && !finding.element.empty(),
                  "a finding that does not say what, where and the mend");
  // The whole search takes a minute under sanitizers.
  const planner::SearchEffort effort{.samples = 6, .refinements = 1, .shapings = 2, .step = 0.02};
  const auto hand = planner::make_hand(*robot, "fuzzed", block, effort);
  if (!hand) return false;
  fuzz::require_sound(hand->model);
  std::size_t made = 0;
  for (const model::HandLink& link : hand->model.links()) made += link.collision.size();
  fuzz::require(made >= solids_of(*robot), "a collision shape was lost");
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  console_bridge::noOutputHandler();
  fuzz::Fuzzer fuzzer;
  fuzzer.seeds = {test::mjcf_gripper(), test::mjcf_three_fingers(), test::mjcf_linkages()};
  for (const fuzz::HandFiles& hand : fuzz::all_hands()) {
    const auto robot = planner::read_robot(hand.urdf);
    fuzz::require(robot.has_value(), "a hand of the lab cannot be read");
    fuzzer.seeds.push_back(test::mjcf_of(*robot, {.degrees = true, .moved = true}));
    fuzzer.seeds.push_back(test::mjcf_of(*robot, {.defaults = true}));
  }
  fuzzer.mutate = [](Random& random, std::string input) {
    return fuzz::mutate_text(random, std::move(input), fuzz::mutate_xml);
  };
  fuzzer.target = make;
  return fuzz::run(fuzzer, argc, argv);
}
