#include "common/tool/output.hpp"
#include "services/mapping/tools/train/train_command.hpp"

int main(int argc, char** argv) {
  return prehend::tool::with_whole_output([&] {
    return prehend::mapping::train_command({argv + 1, argv + argc});
  });
}
