#include "services/demonstration/tools/person/person_command.hpp"

int main(int argc, char** argv) {
  return prehend::demonstration::person_command({argv + 1, argv + argc});
}
