#include "tests/fuzz/robot_target.hpp"

#include <numeric>

#include "services/planner/tools/hand_import/make_hand.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/hand_files.hpp"

namespace prehend::fuzz {
namespace {

template <class Links>
std::size_t solids_of(const Links& links) {
  return std::accumulate(
      links.begin(), links.end(), std::size_t{0},
      [](std::size_t sum, const auto& link) { return sum + link.collision.size(); });
}

}  // namespace

bool check_and_make(const planner::Robot& robot) {
  const auto block = [](const planner::Solid&) -> Expected<std::vector<Eigen::Vector3d>> {
    return std::vector<Eigen::Vector3d>{{0, 0, 0}, {0.02, 0.03, 0.04}};
  };
  for (const planner::UrdfFinding& finding : planner::check(robot, block))
    require(!finding.what.empty() && !finding.repair.empty() && !finding.element.empty(),
            "a finding that does not say what, where and the mend");
  // The whole search takes a minute under sanitizers.
  const planner::SearchEffort effort{.samples = 6, .refinements = 1, .shapings = 2, .step = 0.02};
  const auto hand = planner::make_hand(robot, "fuzzed", block, effort);
  if (!hand) return false;
  require_sound(hand->model);
  require(solids_of(hand->model.links()) >= solids_of(robot.links), "a collision shape was lost");
  return true;
}

}  // namespace prehend::fuzz
