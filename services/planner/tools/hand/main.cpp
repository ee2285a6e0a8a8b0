#include "services/planner/tools/hand/commands.hpp"

int main(int argc, char** argv) {
  using namespace prehend::planner;
  prehend::tool::Program program("hand", "Any URDF as a hand of the lab.");
  add_check(program);
  add_add(program);
  return program.run(argc, argv);
}
