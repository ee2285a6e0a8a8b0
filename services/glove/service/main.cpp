#include "common/service/life_cycle.hpp"
#include "services/glove/service/service.hpp"

int main(int argc, char** argv) {
  return prehend::service::run<prehend::glove::Service>(
      argc, argv, {.name = "glove", .description = "Reads a glove and publishes the hand."});
}
