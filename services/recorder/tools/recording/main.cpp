#include "services/recorder/tools/recording/commands.hpp"

int main(int argc, char** argv) {
  using namespace prehend::recorder;
  prehend::tool::Program program(
      "recording", "Recordings: what is in them, parts of them, and whether two say the same.");
  add_info(program);
  add_cut(program);
  add_merge(program);
  add_recover(program);
  add_verify(program);
  add_diff(program);
  add_export(program);
  add_records(program);
  add_write(program);
  return program.run(argc, argv);
}
