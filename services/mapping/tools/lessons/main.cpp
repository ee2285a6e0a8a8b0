#include "common/service/life_cycle.hpp"
#include "services/mapping/tools/lessons/lessons.hpp"

int main(int argc, char** argv) {
  return prehend::service::run<prehend::mapping::Lessons>(
      argc, argv,
      {.name = "teacher",
       .description = "Learns postures from a person, and trains the mapping, as orders say",
       .role = "mapping"});
}
