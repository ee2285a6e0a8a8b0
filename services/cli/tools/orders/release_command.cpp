#include "services/cli/tools/orders/release_command.hpp"

#include <CLI/CLI.hpp>

#include "services/cli/tools/orders/order.hpp"

namespace prehend::cli {

int release_command(const std::vector<std::string>& arguments) {
  CLI::App app{
      "Ends a stop: robots obey again, and go from where they are, within their limits, to where "
      "they\nare commanded. Exit code 1: not every gate has answered.",
      "prehend release"};
  Order order;
  order.action = v1::ACTION_RELEASE;
  order.add_to(app);
  app.add_option("--reason", order.argument, "why it is safe")->required();
  if (const auto code = service::parse(app, arguments)) return *code;
  if (order.argument.empty())
    return service::complain({"a release needs a reason", "--reason", ""}, exit_wrong_use);
  return give(order);
}

}  // namespace prehend::cli
