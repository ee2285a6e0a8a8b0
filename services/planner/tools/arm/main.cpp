#include "services/planner/tools/arm/commands.hpp"

int main(int argc, char** argv) {
  using namespace prehend::planner;
  prehend::tool::Program program("arm", "Arms of the lab, from their URDF; inverse kinematics.");
  add_check(program);
  add_add(program);
  add_solve(program);
  add_reach(program);
  return program.run(argc, argv);
}
