#include "services/demonstration/tools/demonstrate/demonstrate_command.hpp"

int main(int argc, char** argv) {
  return prehend::demonstration::demonstrate_command({argv + 1, argv + argc});
}
