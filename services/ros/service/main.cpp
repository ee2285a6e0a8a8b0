#include <CLI/CLI.hpp>

#include "common/base/log.hpp"
#include "common/ros2/nodes/nodes.hpp"
#include "common/service/arguments.hpp"
#include "common/tool/output.hpp"
#include "services/ros/service/tell_nodes.hpp"

int main(int argc, char** argv) {
  using namespace prehend;
  CLI::App app{
      "Tells nodes of ROS 2 in the domain ROS_DOMAIN_ID, without a bridge, what the robot hand "
      "and\n"
      "the objects do, until SIGTERM or Ctrl-C.",
      "prehend ros"};
  service::LabArguments lab;
  lab.add_to(app);
  ros::Teller::Options options;
  app.add_option("--network", options.network,
                 "laptop: nodes of this machine; lan: of the network, where everybody may listen; "
                 "without: as ROS_AUTOMATIC_DISCOVERY_RANGE says, else laptop")
      ->check(CLI::IsMember({"laptop", "lan"}));
  app.add_option("--hand", options.hand, "the robot hand that is told; without: the first heard");
  log::set_name("ros");
  return tool::with_whole_output([&] {
    if (const auto code = service::parse(app, {argv + 1, argv + argc})) return *code;
    const auto domain = ros2::domain_of_nodes();
    if (!domain) return service::complain(domain.error(), exit_wrong_use);
    options.domain = *domain;
    const auto config = lab.load();
    if (!config) return service::complain(config.error(), exit_wrong_use);
    return ros::tell_nodes(*config, options);
  });
}
