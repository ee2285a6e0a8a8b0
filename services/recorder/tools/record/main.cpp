#include "services/recorder/tools/record/record_command.hpp"

int main(int argc, char** argv) {
  return prehend::recorder::record_command({argv + 1, argv + argc});
}
