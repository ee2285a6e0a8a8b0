#include "common/tool/output.hpp"
#include "services/demonstration/tools/demonstrate/demonstrate_command.hpp"

int main(int argc, char** argv) {
  return prehend::tool::with_whole_output([&] {
    return prehend::demonstration::demonstrate_command({argv + 1, argv + argc});
  });
}
