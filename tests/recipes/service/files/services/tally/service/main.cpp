#include "common/service/life_cycle.hpp"
#include "services/tally/service/service.hpp"

int main(int argc, char** argv) {
  return prehend::service::run<prehend::tally::Service>(
      argc, argv, {.name = "tally", .description = "Counts grasps, and how many were held."});
}
