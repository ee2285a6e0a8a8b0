#include "common/service/life_cycle.hpp"
#include "services/planner/service/service.hpp"

int main(int argc, char** argv) {
  return prehend::service::run<prehend::planner::Service>(
      argc, argv,
      {.name = "planner", .description = "Says how the robot hand may take what is seen."});
}
