#include "services/recorder/tools/replay/replay_command.hpp"

int main(int argc, char** argv) {
  return prehend::recorder::replay_command({argv + 1, argv + argc});
}
