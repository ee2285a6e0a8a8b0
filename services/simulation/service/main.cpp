#include "common/service/life_cycle.hpp"
#include "services/simulation/service/service.hpp"

int main(int argc, char** argv) {
  return prehend::service::run<prehend::simulation::Service>(
      argc, argv,
      {.name = "simulation", .description = "Moves the robot hand in a physical world."});
}
