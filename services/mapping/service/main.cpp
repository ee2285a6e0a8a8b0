#include "common/service/life_cycle.hpp"
#include "services/mapping/service/service.hpp"

int main(int argc, char** argv) {
  return prehend::service::run<prehend::mapping::Service>(
      argc, argv,
      {.name = "mapping",
       .description = "Turns a human hand's posture into commands for a robot hand"});
}
