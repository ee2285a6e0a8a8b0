// Damaged URDF through `prehend hand check` and `prehend hand add`: findings that say where and
// what, and if a hand is made of it, a sound one with every collision shape of the file in it.
#include <console_bridge/console.h>

#include "services/planner/tools/hand_import/palms.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/hand_files.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/fuzz/robot_target.hpp"

using namespace prehend;

namespace {

bool make(const std::string& urdf) {
  const auto robot = planner::read_robot(urdf);
  if (!robot) {
    fuzz::require(!robot.error().what.empty(), "refused without a reason");
    return false;
  }
  return fuzz::check_and_make(planner::hand_of(*robot));
}

}  // namespace

int main(int argc, char** argv) {
  console_bridge::noOutputHandler();
  fuzz::Fuzzer fuzzer;
  for (const fuzz::HandFiles& hand : fuzz::all_hands()) fuzzer.seeds.push_back(hand.urdf);
  fuzzer.mutate = [](Random& random, std::string text) {
    return fuzz::mutate_text(random, std::move(text), fuzz::mutate_xml);
  };
  fuzzer.target = make;
  return fuzz::run(fuzzer, argc, argv);
}
