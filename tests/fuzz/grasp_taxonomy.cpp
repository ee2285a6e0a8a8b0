// Damaged taxonomies of grasps: a reason, or classes whose numbers and fits are sound.
#include "common/model/grasp_taxonomy.hpp"

#include <cmath>

#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  fuzzer.seeds = {fuzz::read_file(PREHEND_SOURCE "/common/models/grasps/taxonomy.toml")};
  fuzzer.mutate = [](Random& random, std::string text) {
    return fuzz::mutate_text(random, std::move(text), fuzz::mutate_lines);
  };
  fuzzer.target = [](const std::string& text) {
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
