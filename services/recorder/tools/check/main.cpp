#include "common/tool/output.hpp"
#include "services/recorder/tools/check/check_command.hpp"

int main(int argc, char** argv) {
  return prehend::tool::with_whole_output([&] {
    return prehend::recorder::check_command({argv + 1, argv + argc});
  });
}
