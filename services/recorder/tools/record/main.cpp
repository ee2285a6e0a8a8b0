#include "common/tool/output.hpp"
#include "services/recorder/tools/record/record_command.hpp"

int main(int argc, char** argv) {
  return prehend::tool::with_whole_output([&] {
    return prehend::recorder::record_command({argv + 1, argv + argc});
  });
}
