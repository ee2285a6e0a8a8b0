#include "common/service/life_cycle.hpp"
#include "services/performer/service/service.hpp"

int main(int argc, char** argv) {
  return prehend::service::run<prehend::performer::Service>(
      argc, argv,
      {.name = "performer", .description = "Does tasks that were shown, with a robot hand."});
}
