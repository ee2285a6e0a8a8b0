#include <prehend/base/log.hpp>

#include "service.hpp"

int main(int argc, char** argv) {
  int exit_code = 0;
  const auto shell = prehend::service::Shell::create(
      argc, argv,
      {.name = "simulation", .description = "Moves the robot hand in a physical world."},
      exit_code);
  if (!shell) return exit_code;
  const auto service = prehend::simulation::Service::create(*shell, exit_code);
  if (!service) {
    prehend::log::error("{}", service.error().message());
    return exit_code;
  }
  return shell->run();
}
