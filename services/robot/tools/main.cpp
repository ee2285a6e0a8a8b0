#include "services/robot/tools/commands.hpp"

int main(int argc, char** argv) {
  using namespace prehend::robot;
  prehend::tool::Program program("robot", "Robots at the end of a wire.");
  add_emulate(program);
  add_check(program);
  add_home(program);
  add_status(program);
  add_twin(program);
  return program.run(argc, argv);
}
