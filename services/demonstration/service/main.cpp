#include "common/service/life_cycle.hpp"
#include "services/demonstration/service/service.hpp"

int main(int argc, char** argv) {
  return prehend::service::run<prehend::demonstration::Service>(
      argc, argv,
      {.name = "demonstration", .description = "Understands what a hand shows, and learns tasks"});
}
