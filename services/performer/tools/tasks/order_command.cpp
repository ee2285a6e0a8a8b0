// `prehend tasks order`.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/to_terminal.hpp"
#include "common/dds/topics.hpp"
#include "common/service/arguments.hpp"
#include "common/service/shell.hpp"
#include "services/performer/tools/tasks/commands.hpp"

namespace prehend::performer {
namespace {

constexpr Duration order_period = std::chrono::milliseconds(100);
constexpr Duration patience = std::chrono::seconds(5);

struct OrderArguments {
  service::LabArguments lab;
  std::string task;
  bool end = false, json = false;
};

int order(const OrderArguments& arguments) {
  auto made = service::Shell::create(arguments.lab.for_service(),
                                     {"operator-tasks", "Orders a task.", "operator", false});
  if (!made) return service::complain(made.error());
  service::Shell& shell = **made;
  const Time begin = shell.now();
  v1::OperatorCommand order;
  order.id(fmt::format("tasks-{}-{}", ::getpid(), to_ns(begin) / 1'000'000));
  order.stamp_ns(to_ns(begin));
  order.action(arguments.end ? v1::ACTION_STOP : v1::ACTION_START);
  order.target("performer");
  order.argument(arguments.task);
  std::optional<v1::OperatorReply> answer;
  const auto orders = shell.publish(dds::operator_command);
  shell.subscribe(dds::operator_reply,
                  std::function([&](const v1::OperatorReply& reply, const dds::SampleInfo& info) {
                    if (info.gone || reply.id().to_string() != order.id().to_string()) return;
                    answer = reply;
                    shell.stop();
                  }));
  shell.on_tick(order_period, [&](Time now) {
    if (now - begin > patience) return shell.stop();
    orders.publish(order);
  });
  shell.status().running();
  if (const auto ended = shell.run(); !ended) return service::complain(ended.error());
  if (!answer)
    return service::complain({"nobody answers", "performer", "is prehend-performer there?"},
                             exit_no);
  const std::string message = answer->message().to_string();
  if (arguments.json)
    std::cout << nlohmann::ordered_json{{"task", arguments.task},
                                        {"done", answer->done()},
                                        {"message", message}}
                     .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)
              << "\n";
  else
    to_terminal("{}\n", message);
  return answer->done() ? exit_done : exit_no;
}

}  // namespace

void add_order(tool::Program& program) {
  auto arguments = std::make_shared<OrderArguments>();
  CLI::App* command = program.app().add_subcommand(
      "order",
      "Lets the lab's performer begin a task, and does not wait for it (task/progress tells). Exit "
      "code 1: it does not.");
  arguments->lab.add_to(*command);
  command->add_option("task", arguments->task, "its name")->required();
  command->add_flag("--end", arguments->end, "ends it; the hand stays where it is");
  command->add_flag("--json", arguments->json, "one JSON document");
  program.on(*command, [arguments] { return order(*arguments); });
}

}  // namespace prehend::performer
