#include "services/ros/service/tell_nodes.hpp"

#include <fmt/format.h>

#include <iostream>

#include "common/base/clock.hpp"
#include "common/service/arguments.hpp"
#include "common/service/supervisor.hpp"
#include "common/tool/interrupt.hpp"

namespace prehend::ros {
namespace {

constexpr Duration beat = std::chrono::milliseconds(100);

}  // namespace

int tell_nodes(const service::Config& config, const Teller::Options& options) {
  auto teller = Teller::create(config, options);
  if (!teller) return service::complain(teller.error());
  tool::note_interrupts();
  std::cout << fmt::format(
                   "domain {} of ROS 2: /joint_states /robot_description /tf /tf_static "
                   "/detections /diagnostics\n/camera/image/compressed "
                   "/camera/camera_info\n",
                   options.domain)
            << std::flush;
  service::Supervisor supervisor;
  while (!tool::interrupted()) {
    (*teller)->tell(beat);
    supervisor.beat(process_now());
  }
  supervisor.stopping();
  return exit_done;
}

}  // namespace prehend::ros
