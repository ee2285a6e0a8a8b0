#include "services/ros/service/tell_nodes.hpp"

#include <fmt/format.h>

#include <csignal>
#include <iostream>

#include "common/base/clock.hpp"
#include "common/service/arguments.hpp"
#include "common/service/supervisor.hpp"

namespace prehend::ros {
namespace {

constexpr Duration beat = std::chrono::milliseconds(100);

volatile std::sig_atomic_t ended = 0;
extern "C" void on_end(int) {
  ended = 1;
}

}  // namespace

int tell_nodes(const service::Config& config, const Teller::Options& options) {
  auto teller = Teller::create(config, options);
  if (!teller) return service::complain(teller.error());
  struct sigaction action {};
  action.sa_handler = on_end;
  ::sigaction(SIGTERM, &action, nullptr);
  ::sigaction(SIGINT, &action, nullptr);
  std::cout << fmt::format("domain {} of ROS 2: /joint_states /robot_description /tf /tf_static\n",
                           options.domain)
            << std::flush;
  service::Supervisor supervisor;
  while (ended == 0) {
    (*teller)->tell(beat);
    supervisor.beat(process_now());
  }
  supervisor.stopping();
  return exit_done;
}

}  // namespace prehend::ros
