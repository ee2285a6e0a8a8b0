#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "common/base/clock.hpp"
#include "common/base/log.hpp"
#include "common/ros2/nodes/nodes.hpp"
#include "common/service/arguments.hpp"
#include "common/service/supervisor.hpp"
#include "common/tool/interrupt.hpp"
#include "services/ros/service/teller.hpp"

namespace {

using namespace prehend;

constexpr Duration beat = std::chrono::milliseconds(100);

int run(const service::Config& config, const ros::Teller::Options& options) {
  auto teller = ros::Teller::create(config, options);
  if (!teller) return service::complain(teller.error());
  tool::note_interrupts();
  std::cout << fmt::format("domain {} of ROS 2: /joint_states /robot_description /tf /tf_static\n",
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

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Tells nodes of ROS 2 in the domain ROS_DOMAIN_ID, without a bridge, what the robot hand "
      "and\n"
      "the objects do, until SIGTERM or Ctrl-C.",
      "prehend ros"};
  service::LabArguments lab;
  lab.add_to(app);
  ros::Teller::Options options;
  app.add_option("--network", options.network,
                 "laptop: nodes of this machine; lan: of the network, where everybody may listen")
      ->check(CLI::IsMember({"laptop", "lan"}))
      ->capture_default_str();
  app.add_option("--hand", options.hand, "the robot hand that is told; without: the first heard");
  log::set_name("ros");
  if (const auto code = service::parse(app, {argv + 1, argv + argc})) return *code;
  const auto domain = ros2::domain_of_nodes();
  if (!domain) return service::complain(domain.error(), exit_wrong_use);
  options.domain = *domain;
  const auto config = lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  return run(*config, options);
}
