// Damaged MJCF through `prehend hand check` and `prehend hand add`: findings that say where and
// what, and if a hand is made of it, a sound one with every collision shape of the file in it.
#include <console_bridge/console.h>

#include "services/planner/tools/hand_import/mjcf.hpp"
#include "services/planner/tools/hand_import/palms.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/hand_files.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/fuzz/robot_target.hpp"
#include "tests/support/mjcf/mjcf_text.hpp"

using namespace prehend;

namespace {

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
  return fuzz::check_and_make(planner::hand_of(*robot));
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
