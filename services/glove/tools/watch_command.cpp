#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <iostream>
#include <memory>
#include <thread>

#include "common/base/terminal.hpp"
#include "common/dds/participant.hpp"
#include "common/service/arguments.hpp"
#include "common/service/consent_key.hpp"
#include "common/service/membership.hpp"
#include "common/service/shell.hpp"
#include "common/tool/interrupt.hpp"
#include "common/tool/keyboard.hpp"
#include "services/glove/tools/commands.hpp"
#include "services/glove/tools/frame_input.hpp"
#include "services/glove/tools/watch_view.hpp"

namespace prehend::glove {
namespace {

using Clock = std::chrono::steady_clock;

struct WatchArguments {
  service::LabArguments lab;
  double duration = 0;  // s; 0: until somebody ends it
  bool json = false, consent = false;
};

/// Consent by the space bar, while somebody watches: an operator beside the viewer.
class Consent {
 public:
  static Expected<std::unique_ptr<Consent>> create(const service::LabArguments& lab) {
    auto shell = service::Shell::create(
        lab.for_service(), {"operator-watch", "Gives consent by a key.", "operator", false});
    if (!shell) return tl::unexpected(shell.error());
    return std::make_unique<Consent>(std::move(*shell));
  }
  explicit Consent(std::unique_ptr<service::Shell> shell)
      : shell_(std::move(shell)), key_(*shell_, shell_->config().text("mapping.hand_name")) {
    shell_->on_tick(service::ConsentKey::period, [this](Time now) {
      while (const auto pressed = keyboard_.key()) {
        if (*pressed == ' ') key_.press(now);
        if (*pressed == 'q') return shell_->stop();
      }
      key_.tick(now);
    });
    shell_->status().running();
    thread_ = std::jthread([this] {
      (void)shell_->run();
      key_.end();
      ended_ = true;
    });
  }
  ~Consent() { shell_->stop(); }
  Consent(const Consent&) = delete;
  Consent& operator=(const Consent&) = delete;

  /// By q, or a signal.
  bool ended() const { return ended_; }

 private:
  std::unique_ptr<service::Shell> shell_;
  service::ConsentKey key_;
  tool::Keyboard keyboard_;
  std::atomic<bool> ended_ = false;
  std::jthread thread_;  // last: joined before the rest goes
};

Time now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

int watch(const WatchArguments& arguments) {
  const auto config = arguments.lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  auto participant =
      dds::Participant::create(service::membership(*config, "glove-watch", "viewer"));
  if (!participant) return service::complain(participant.error(), exit_broken);
  auto frames = participant->reader(dds::glove_frame);
  auto postures = participant->reader(dds::hand_posture);
  auto statuses = participant->reader(dds::service_status);
  if (!frames) return service::complain(frames.error(), exit_broken);
  if (!postures) return service::complain(postures.error(), exit_broken);
  if (!statuses) return service::complain(statuses.error(), exit_broken);
  tool::note_interrupts();

  constexpr double snapshot_after = 2;  // s, in which every topic says something
  const double duration =
      arguments.duration > 0 ? arguments.duration : (arguments.json ? snapshot_after : 1e9);
  const bool terminal = !arguments.json && has_cursor(STDOUT_FILENO);
  const auto pause = std::chrono::milliseconds(terminal ? 250 : 1000);
  std::unique_ptr<Consent> consent;
  if (arguments.consent) {
    auto made = Consent::create(arguments.lab);
    if (!made) return service::complain(made.error());
    consent = std::move(*made);
  }
  WatchView view(config->text("glove.name"));
  const Clock::time_point begin = Clock::now();
  Clock::time_point shown = begin;
  if (terminal) std::cout << "\x1b[2J";
  while (!tool::interrupted() &&
         std::chrono::duration<double>(Clock::now() - begin).count() < duration) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    for (const auto& sample : frames->take())
      if (!sample.info.gone) view.hear(sample.data, now());
    for (const auto& sample : postures->take())
      if (!sample.info.gone) view.hear(sample.data, now());
    for (const auto& sample : statuses->take())
      if (sample.info.gone)
        view.lost_service(sample.data.service().to_string());
      else
        view.hear(sample.data);
    if (consent ? consent->ended() : terminal && entered_key() == 'q') break;
    if (arguments.json || Clock::now() - shown < pause) continue;
    shown = Clock::now();
    // Written over the page before: each line's and the page's old rest is erased.
    std::string page = view.page(now());
    if (terminal) {
      std::string lines;
      for (const char c : page) lines += c == '\n' ? std::string("\x1b[K\n") : std::string(1, c);
      page = "\x1b[H" + lines + "\x1b[J";
    }
    std::cout << page << std::flush;
  }
  if (arguments.json) std::cout << view.json(now()) << '\n';
  return view.heard_something() ? exit_done : exit_no;
}

}  // namespace

void add_watch(tool::Program& program) {
  auto* command = program.app().add_subcommand(
      "watch", "what the glove says: sensors, rates, rejections, fingertips; q and Enter ends");
  const auto a = std::make_shared<WatchArguments>();
  a->lab.add_to(*command);
  command->add_option("--for", a->duration, "s after which it ends")->check(CLI::Range(0.1, 1e9));
  command->add_flag("--json", a->json, "one snapshot as a JSON document, after 2 s");
  command->add_flag("--consent", a->consent,
                    "the space bar, while it is held, is the deadman of the lab's hand; q ends");
  program.on(*command, [a] { return watch(*a); });
}

}  // namespace prehend::glove
