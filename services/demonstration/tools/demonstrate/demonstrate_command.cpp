// prehend-demonstrate: an operator says when a demonstration begins and ends.
#include "services/demonstration/tools/demonstrate/demonstrate_command.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/base/log.hpp"
#include "common/base/printable.hpp"
#include "common/dds/topics.hpp"
#include "common/service/arguments.hpp"
#include "common/service/shell.hpp"

namespace prehend::demonstration {
namespace {

constexpr Duration order_period = std::chrono::milliseconds(100);
constexpr Duration patience = std::chrono::seconds(5);   // until the first answer
constexpr Duration thinking = std::chrono::seconds(30);  // until a demonstration is understood

struct Arguments {
  service::LabArguments lab;
  std::string name;
  double seconds = 0;  // 0: until Enter is pressed
  int button = 0;      // of the tracker: pressed, it begins, pressed again, it ends; 0: none
  bool begin = false, end = false, json = false;
};

/// Gives the two orders, each until it is answered.
class Session {
 public:
  Session(service::Shell& shell, const Arguments& arguments)
      : shell_(shell),
        arguments_(arguments),
        orders_(shell.publish(dds::operator_command)),
        step_(arguments.end          ? Step::end
              : arguments.button > 0 ? Step::wait
                                     : Step::begin),
        since_(shell.now()) {
    shell.subscribe(dds::operator_reply, std::function([this](const v1::OperatorReply& reply,
                                                              const dds::SampleInfo& info) {
                      if (!info.gone && reply.id().to_string() == id()) answered(reply);
                    }));
    if (arguments.button > 0) {
      shell.subscribe(dds::glove_button, std::function([this](const v1::GloveButton& button,
                                                              const dds::SampleInfo& info) {
                        if (!info.gone) on_button(button);
                      }));
      log::info("press button {} to begin, and again when it is over", arguments.button);
    }
    shell.on_tick(order_period, [this](Time now) { tick(now); });
    shell.status().running();
  }

  bool done() const { return done_; }
  const std::string& message() const { return message_; }

 private:
  enum class Step { wait, begin, watch, end };

  std::string id() const {
    return fmt::format("demonstrate-{}-{}-{}", ::getpid(), to_ns(since_) / 1000000,
                       step_ == Step::begin ? "begin" : "end");
  }

  /// Counts where it was up before: what is held already when we come begins nothing.
  void on_button(const v1::GloveButton& message) {
    if (message.glove().to_string() != shell_.config().text("glove.name")) return;
    const auto& held = message.held();
    const bool down = std::find(held.begin(), held.end(), arguments_.button) != held.end();
    const bool pressed = down && !down_;
    down_ = down;
    if (!pressed) return;
    if (step_ == Step::wait) go(Step::begin, shell_.now());
    if (step_ == Step::watch) go(Step::end, shell_.now());
  }

  void tick(Time now) {
    if (step_ == Step::wait) return;
    if (step_ == Step::watch) {
      if (is_over(now)) go(Step::end, now);
      return;
    }
    if (now - since_ > (step_ == Step::begin ? patience : thinking)) {
      message_ = "nobody answers; is prehend-demonstration there? prehend status";
      return shell_.stop();
    }
    v1::OperatorCommand order;
    order.id(id());
    order.stamp_ns(to_ns(now));
    order.action(step_ == Step::begin ? v1::ACTION_START : v1::ACTION_STOP);
    order.target("demonstration");
    order.argument(arguments_.name);
    orders_.publish(order);
  }

  void go(Step step, Time now) {
    step_ = step;
    since_ = now;
  }

  void answered(const v1::OperatorReply& reply) {
    message_ = reply.message().to_string();
    const bool last = step_ == Step::end || arguments_.begin;
    if (!reply.done() || last) {
      done_ = reply.done();
      return shell_.stop();
    }
    if (step_ != Step::begin) return;
    go(Step::watch, shell_.now());
    if (arguments_.seconds <= 0)
      log::info("{}; press {} when it is over", message_,
                arguments_.button > 0 ? "the button" : "Enter");
  }

  bool is_over(Time now) const {
    if (arguments_.seconds > 0) return now - since_ > prehend::seconds(arguments_.seconds);
    if (arguments_.button > 0) return false;
    pollfd input{STDIN_FILENO, POLLIN, 0};
    return ::poll(&input, 1, 0) > 0;
  }

  service::Shell& shell_;
  const Arguments& arguments_;
  service::Shell::Output<v1::OperatorCommand> orders_;
  Step step_;
  Time since_;
  bool down_ = true;  // the button, as it was said last
  bool done_ = false;
  std::string message_ = "interrupted; the demonstration goes on until prehend demonstrate --end";
};

int demonstrate(const Arguments& arguments) {
  auto shell = service::Shell::create(
      arguments.lab.for_service(),
      {"demonstrate", "Begins and ends a demonstration.", "operator", false});
  if (!shell) return service::complain(shell.error());
  Session session(**shell, arguments);
  if (const auto ended = (*shell)->run(); !ended) return service::complain(ended.error());
  if (arguments.json)
    std::cout << nlohmann::ordered_json{{"done", session.done()}, {"message", session.message()}}
                     .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)
              << "\n";
  else if (session.done())
    std::cout << printable(session.message()) << "\n";
  else
    service::complain(Error{session.message(), {}, {}, exit_no});
  return session.done() ? exit_done : exit_no;
}

}  // namespace

int demonstrate_command(const std::vector<std::string>& texts) {
  CLI::App app{
      "Shows the lab a task: it watches from now on until Enter is pressed, and says what it "
      "understood.\nShown again under the same name, the task is refined. Exit code 1: it was not "
      "understood, and\nnothing was changed.",
      "prehend demonstrate"};
  Arguments arguments;
  arguments.lab.add_to(app);
  app.add_option("--name", arguments.name, "of the task");
  app.add_option("--seconds", arguments.seconds, "ends by itself after so long")
      ->check(CLI::Range(0.1, 600.0));
  auto* begin = app.add_flag("--begin", arguments.begin, "only begins");
  auto* end = app.add_flag("--end", arguments.end, "only ends")->excludes(begin);
  app.add_option(
         "--button", arguments.button,
         "of the tracker: it begins when this is pressed, and ends when it is pressed again")
      ->check(CLI::Range(1, 8))
      ->excludes(begin)
      ->excludes(end);
  app.add_flag("--json", arguments.json, "one JSON document");
  if (const auto code = service::parse(app, texts)) return *code;
  if (arguments.name.empty() && !arguments.end)
    return service::complain(wrong_use("needs a name", "--name", "of the task").value(),
                             exit_wrong_use);
  return demonstrate(arguments);
}

}  // namespace prehend::demonstration
