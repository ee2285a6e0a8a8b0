#include <prehend/base/log.hpp>

#include "service.hpp"

int main(int argc, char** argv) {
  int exit_code = 0;
  const auto shell = prehend::service::Shell::create(
      argc, argv, {"mapping", "Turns a human hand's posture into commands for a robot hand"},
      exit_code);
  if (!shell) return exit_code;
  const auto ended = prehend::mapping::run(*shell);
  if (!ended) {
    prehend::log::error("{}", ended.error().message());
    return 3;
  }
  return *ended;
}
