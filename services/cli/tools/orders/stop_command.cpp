#include "services/cli/tools/orders/stop_command.hpp"

#include <CLI/CLI.hpp>

#include "common/tool/keyboard.hpp"
#include "services/cli/tools/orders/order.hpp"

namespace prehend::cli {

int stop_command(const std::vector<std::string>& arguments) {
  CLI::App app{
      "Stops the robots of the rig: they obey nothing any more until `prehend release`. Fingers "
      "hold or\nopen (safety.on_stop), the base stays. Exit code 1: not every gate has answered.",
      "prehend stop"};
  Order order;
  order.action = v1::ACTION_STOP;
  order.add_to(app);
  app.add_option("--reason", order.argument, "why, for those who read of it");
  app.add_flag("--key", order.on_key, "wait for a key, and stop as soon as it is pressed");
  if (const auto code = service::parse(app, arguments)) return *code;
  if (order.on_key && order.rigs.size() > 1)
    return service::complain({"waits in one rig", "--key", "give one --rig, or --all"},
                             exit_wrong_use);
  if (order.on_key && !tool::Keyboard().is_there())
    return service::complain({"needs a terminal, in its foreground", "--key", "leave it out"},
                             exit_wrong_use);
  return give(order);
}

}  // namespace prehend::cli
