#include "common/tool/output.hpp"
#include "services/mapping/tools/study/study_command.hpp"

int main(int argc, char** argv) {
  return prehend::tool::with_whole_output([&] {
    return prehend::mapping::study_command({argv + 1, argv + argc});
  });
}
