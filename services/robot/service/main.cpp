#include "common/service/life_cycle.hpp"
#include "services/robot/service/service.hpp"

int main(int argc, char** argv) {
  // To others a robot is what the simulation is, so it has the rights of that.
  return prehend::service::run<prehend::robot::Service>(
      argc, argv,
      {.name = "robot", .description = "Drives a real robot hand.", .role = "simulation"});
}
