#include "services/planner/tools/grasp/commands.hpp"
#include "services/planner/tools/grasp/planning_commands.hpp"

int main(int argc, char** argv) {
  using namespace prehend::planner;
  prehend::tool::Program program("grasp", "What can be said of a grasp.");
  add_quality(program);
  add_plan(program);
  add_candidates(program);
  add_export(program);
  add_picture(program);
  add_table(program);
  add_taxonomy(program);
  add_classify(program);
  return program.run(argc, argv);
}
