#include "services/cli/tools/orders/consent_command.hpp"

#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <optional>

#include "common/base/log.hpp"
#include "common/service/consent_key.hpp"
#include "common/service/shell.hpp"
#include "common/tool/keyboard.hpp"
#include "services/cli/tools/orders/order.hpp"

namespace prehend::cli {
namespace {

struct Ways {
  bool key = false;   // while the space bar is held
  double for_s = 0;   // this long; 0: not so
  int while_pid = 0;  // while this process lives; 0: not so
};

class Consent {
 public:
  Consent(service::Shell& shell, const std::string& hand, const Ways& ways)
      : shell_(shell), ways_(ways), begun_(shell.now()), key_(shell, hand) {
    if (ways.key) {
      keyboard_.emplace();
      log::info("hold the space bar; q ends");
    }
    shell.on_tick(service::ConsentKey::period, [this](Time now) { tick(now); });
    shell.status().running();
  }

  /// Lets go, whatever it ended for.
  void end() { key_.end(); }

 private:
  void tick(Time now) {
    if (keyboard_)
      while (const auto key = keyboard_->key()) {
        if (*key == 'q') return shell_.stop();
        if (*key == ' ') key_.press(now);
      }
    if (ways_.for_s > 0 && now - begun_ > seconds(ways_.for_s)) return shell_.stop();
    if (ways_.while_pid > 0 && ::kill(ways_.while_pid, 0) != 0 && errno == ESRCH)
      return shell_.stop();
    key_.tick(now, !ways_.key);
  }

  service::Shell& shell_;
  Ways ways_;
  Time begun_;
  service::ConsentKey key_;
  std::optional<tool::Keyboard> keyboard_;
};

int consent(const service::LabArguments& lab, std::string hand, const Ways& ways) {
  const auto config = lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  if (hand.empty()) hand = config->text("mapping.hand_name");
  const auto shell = service::Shell::create(
      lab.for_service(), {operator_name(), "Holds the deadman.", "operator", false});
  if (!shell) return service::complain(shell.error());
  Consent consent(**shell, hand, ways);
  const auto ended = (*shell)->run();
  consent.end();
  return ended ? *ended : service::complain(ended.error());
}

}  // namespace

int consent_command(const std::vector<std::string>& arguments) {
  CLI::App app{
      "Holds the deadman of a robot hand: where safety.deadman is set, the hand moves only "
      "meanwhile.",
      "prehend consent"};
  service::LabArguments lab;
  std::string hand;
  Ways ways;
  lab.add_to(app);
  app.add_option("--hand", hand, "key of its topics; default: mapping.hand_name");
  auto* way = app.add_option_group("while")->require_option(1);
  way->add_flag("--hold", ways.key, "while the space bar is held");
  way->add_option("--for", ways.for_s, "so many seconds")->check(CLI::Range(0.1, 86400.0));
  way->add_option("--while-pid", ways.while_pid, "while this process lives")
      ->check(CLI::Range(1, 1 << 30));
  if (const auto code = service::parse(app, arguments)) return *code;
  if (ways.key && ::isatty(STDIN_FILENO) == 0)
    return service::complain({"needs a terminal", "--hold", "--for or --while-pid in scripts"},
                             exit_wrong_use);
  return consent(lab, hand, ways);
}

}  // namespace prehend::cli
