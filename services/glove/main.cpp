#include <prehend/base/log.hpp>

#include "service.hpp"

int main(int argc, char** argv) {
  int exit_code = 0;
  const auto shell = prehend::service::Shell::create(
      argc, argv, {.name = "glove", .description = "Reads a glove and publishes the hand."},
      exit_code);
  if (!shell) return exit_code;
  const auto service = prehend::glove::Service::create(*shell, exit_code);
  if (!service) {
    prehend::log::error("{}", service.error().message());
    return exit_code;
  }
  return shell->run();
}
