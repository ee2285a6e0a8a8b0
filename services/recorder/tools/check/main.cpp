#include "services/recorder/tools/check/check_command.hpp"

int main(int argc, char** argv) {
  return prehend::recorder::check_command({argv + 1, argv + argc});
}
