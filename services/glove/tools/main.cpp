#include "services/glove/tools/commands.hpp"

int main(int argc, char** argv) {
  using namespace prehend::glove;
  prehend::tool::Program program("glove", "Tools of the glove.");
  add_devices(program);
  add_decode(program);
  add_emulate(program);
  add_calibrate(program);
  add_register(program);
  add_watch(program);
  add_filter_report(program);
  return program.run(argc, argv);
}
