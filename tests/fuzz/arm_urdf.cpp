// Damaged URDF as an arm's own file and through `prehend arm add`: refused with a reason, or a
// sound arm that answers.
#include <console_bridge/console.h>

#include "common/arm/inverse.hpp"
#include "services/planner/tools/arm_import/make_arm.hpp"
#include "tests/fuzz/arm_files.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/support/arms/arms.hpp"

using namespace prehend;

namespace {

bool answers(const std::string& urdf) {
  for (const test::ArmFiles& files : test::all_arms()) {
    const auto arm = model::ArmModel::parse(urdf, files.toml);
    fuzz::require(arm || !arm.error().what.empty(), "refused without a reason");
    if (arm) fuzz::require_sound(*arm);
  }
  const auto robot = planner::read_robot(urdf);
  if (!robot) return false;
  const auto block = [](const planner::Solid&) -> Expected<std::vector<Eigen::Vector3d>> {
    return std::vector<Eigen::Vector3d>{{0, 0, 0}, {0.02, 0.03, 0.04}};
  };
  for (const planner::UrdfFinding& finding : planner::check_arm(*robot, block))
    fuzz::require(!finding.what.empty() && !finding.repair.empty() && !finding.element.empty(),
                  "a finding that does not say what, where and the mend");
  const auto made = planner::make_arm(*robot, "fuzzed", block);
  fuzz::require(made || !made.error().what.empty(), "refused without a reason");
  if (!made) return false;
  fuzz::require_sound(made->model);
  const arm::SearchOptions few{.max_starts = 4, .patience = 4};
  arm::Inverse(made->model, few).branches(arm::end_pose(made->model, made->model.home));
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  console_bridge::noOutputHandler();
  fuzz::Fuzzer fuzzer;
  for (const test::ArmFiles& files : test::all_arms()) fuzzer.seeds.push_back(files.urdf);
  fuzzer.mutate = [](Random& random, std::string text) {
    return fuzz::mutate_text(random, std::move(text), fuzz::mutate_xml);
  };
  fuzzer.target = answers;
  return fuzz::run(fuzzer, argc, argv);
}
