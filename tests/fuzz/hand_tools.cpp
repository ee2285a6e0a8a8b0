// Damaged URDF through `prehend hand check` and `prehend hand add`: findings that say where and
// what, and if a hand is made of it, a sound one with every collision shape of the file in it.
#include <console_bridge/console.h>

#include <numeric>

#include "services/planner/tools/hand_import/make_hand.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/hand_files.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;

namespace {

std::size_t solids_of(const planner::Robot& robot) {
  return std::accumulate(
      robot.links.begin(), robot.links.end(), std::size_t{0},
      [](std::size_t sum, const auto& link) { return sum + link.collision.size(); });
}

bool make(const std::string& urdf) {
  const auto robot = planner::read_robot(urdf);
  if (!robot) {
    fuzz::require(!robot.error().what.empty(), "refused without a reason");
    return false;
  }
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
  for (const fuzz::HandFiles& hand : fuzz::all_hands()) fuzzer.seeds.push_back(hand.urdf);
  fuzzer.mutate = [](Random& random, std::string text) {
    return fuzz::mutate_text(random, std::move(text), fuzz::mutate_xml);
  };
  fuzzer.target = make;
  return fuzz::run(fuzzer, argc, argv);
}
