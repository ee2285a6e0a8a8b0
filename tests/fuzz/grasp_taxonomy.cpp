// Damaged taxonomies of grasps and kinds of tasks: a reason, or classes whose numbers and fits are
// sound, and tasks that have a name.
#include "common/model/grasp_taxonomy.hpp"

#include <cmath>

#include "common/model/task_kinds.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/support/paths/paths.hpp"

using namespace prehend;

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  fuzzer.seeds = {fuzz::read_file(test::in_sources("common/models/grasps/taxonomy.toml")),
                  fuzz::read_file(test::in_sources("common/models/tasks/tasks.toml"))};
  fuzzer.mutate = [](Random& random, std::string text) {
    return fuzz::mutate_text(random, std::move(text), fuzz::mutate_lines);
  };
  fuzzer.target = [](const std::string& text) {
    const auto tasks = model::TaskKinds::parse(text);
    fuzz::require(tasks || !tasks.error().what.empty(), "refused without a reason");
    if (tasks) {
      for (const model::TaskKind& kind : tasks->kinds())
        fuzz::require(tasks->of_task(kind.name) != nullptr, "a kind that no task is of");
      return true;
    }
    const auto taxonomy = model::GraspTaxonomy::parse(text);
    fuzz::require(taxonomy || !taxonomy.error().what.empty(), "refused without a reason");
    if (!taxonomy) return false;
    const model::Shape cup{model::ShapeKind::cylinder, {0.033, 0.033, 0.093}};
    for (const double fit : taxonomy->fit_to_object(cup))
      fuzz::require(fit >= 0 && fit <= 1, "a fit is no share");
    for (const model::GraspClass& one : taxonomy->classes())
      fuzz::require(!one.opposed.empty() && one.min_width > 0 && one.max_width > one.min_width,
                    "a class without fingers or width");
    return true;
  };
  return fuzz::run(fuzzer, argc, argv);
}
