#include "services/console/service/recording.hpp"

#include <CLI/CLI.hpp>
#include <csignal>
#include <iostream>
#include <thread>

#include "common/base/clock.hpp"
#include "common/base/log.hpp"
#include "common/service/arguments.hpp"
#include "services/console/service/film.hpp"
#include "services/console/service/setup.hpp"
#include "services/console/service/show.hpp"

namespace prehend::console {
namespace {

/// Blocked before any thread is there, and waited for in one place.
class EndSignals {
 public:
  EndSignals() {
    sigemptyset(&set_);
    sigaddset(&set_, SIGTERM);
    sigaddset(&set_, SIGINT);
    ::pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  }
  void wait() const {
    int number = 0;
    ::sigwait(&set_, &number);
  }

 private:
  sigset_t set_{};
};

Expected<void> show(const service::Config& config, const std::string& file) {
  const EndSignals signals;
  const auto film = Film::open(file);
  if (!film) return tl::unexpected(film.error());
  auto policy = policy_of(config);
  if (!policy) return tl::unexpected(policy.error());
  const auto made =
      Show::create(config, {.policy = std::move(*policy),
                            .letters = [&] { return (*film)->letters(process_now()); },
                            .now_ns = [&] { return to_ns((*film)->time()); },
                            .no_hand = "this is a recording: its hand is that of then",
                            .film = film->get()});
  if (!made) return tl::unexpected(made.error());
  const auto served = serve(config, **made);
  if (!served) return tl::unexpected(served.error());
  std::cout << served->address << std::endl;
  std::thread thread([&] { served->server->run(); });
  signals.wait();
  served->server->stop();
  thread.join();
  return {};
}

}  // namespace

int show_recording(const std::vector<std::string>& arguments) {
  CLI::App app{"Shows a recording in a browser, over and over, without a lab. Prints the address.",
               "prehend console"};
  service::LabArguments lab;
  std::string file;
  lab.add_to(app);
  app.add_option("--recording", file, "MCAP file of `prehend record`")->required();
  log::set_name("console");
  if (const auto code = service::parse(app, arguments)) return *code;
  const auto config = lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  if (const auto shown = show(*config, file); !shown) return service::complain(shown.error());
  return exit_done;
}

}  // namespace prehend::console
