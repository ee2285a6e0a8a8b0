#include "services/performer/tools/tasks/commands.hpp"

int main(int argc, char** argv) {
  using namespace prehend::performer;
  prehend::tool::Program program("tasks", "Tasks that were shown.");
  add_list(program);
  add_show(program);
  add_edit(program);
  add_check(program);
  add_run(program);
  add_order(program);
  add_demo(program);
  add_evaluate(program);
  return program.run(argc, argv);
}
