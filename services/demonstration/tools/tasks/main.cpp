#include "services/demonstration/tools/tasks/commands.hpp"

int main(int argc, char** argv) {
  using namespace prehend::demonstration;
  prehend::tool::Program program("tasks", "Tasks that were shown.");
  add_list(program);
  add_show(program);
  add_check(program);
  return program.run(argc, argv);
}
