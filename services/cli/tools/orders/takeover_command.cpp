#include "services/cli/tools/orders/takeover_command.hpp"

#include <CLI/CLI.hpp>

#include "services/cli/tools/orders/order.hpp"

namespace prehend::cli {

int takeover_command(const std::vector<std::string>& arguments) {
  CLI::App app{
      "From now on the robot hand obeys the commands of this writer, or mapping follows the "
      "postures "
      "of\nthis glove, and of no other. Exit code 1: it is not there.",
      "prehend takeover"};
  Order order;
  order.action = v1::ACTION_TAKE_OVER;
  order.add_to(app);
  app.add_option(
         "name", order.argument,
         "as `prehend status` calls it, mapping@host/123; or mapping, glove, replayer: the one "
         "that does\nnot lead")
      ->required();
  if (const auto code = service::parse(app, arguments)) return *code;
  return give(order);
}

}  // namespace prehend::cli
