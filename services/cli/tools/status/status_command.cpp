#include "services/cli/tools/status/status_command.hpp"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <thread>

#include "common/base/clock.hpp"
#include "common/base/terminal.hpp"
#include "common/dds/participant.hpp"
#include "common/service/arguments.hpp"
#include "common/service/membership.hpp"
#include "common/tool/interrupt.hpp"
#include "services/cli/service/self_reports.hpp"
#include "services/cli/tools/status/status_view.hpp"

namespace prehend::cli {
namespace {

/// The last character that was entered on standard input; 0: none. Does not wait.
char entered_key() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char key = 0, next = 0;
  while (::poll(&input, 1, 0) == 1 && (input.revents & POLLIN) &&
         ::read(STDIN_FILENO, &next, 1) == 1)
    if (next != '\n') key = next;
  return key;
}

/// The page written over the one before, as far as the terminal reaches.
void show(const std::string& page) {
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_row < 2) size.ws_row = 50;
  std::string text = "\x1b[H";
  std::size_t begin = 0;
  for (int row = 1; row < size.ws_row && begin < page.size(); ++row) {
    const std::size_t end = page.find('\n', begin);
    text += page.substr(begin, end - begin) + "\x1b[K\n";
    begin = end + 1;
  }
  std::cout << text << "\x1b[J" << (begin < page.size() ? "(more than fits; --once shows all)" : "")
            << std::flush;
}

struct Arguments {
  service::LabArguments lab;
  std::vector<std::string> awaited;
  bool json = false, once = false;
  double timeout = 1.5;

  void add_to(CLI::App& app) {
    lab.add_to(app);
    app.add_option("--wait", awaited,
                   "ends as soon as this service is up, with exit code 1 when it is not in time; "
                   "repeatable, and twice the same awaits two of it")
        ->type_size(1)
        ->allow_extra_args(false);
    app.add_option("--timeout", timeout, "s to listen, where the table is not renewed")
        ->capture_default_str()
        ->check(CLI::Range(0.1, 3600.0));
    app.add_flag("--once", once, "one table, also on a terminal");
    app.add_flag("--json", json, "one JSON document on standard output");
  }
};

void tell(StatusView& view, SelfReports& reports, const dds::Participant& participant, Time now) {
  const auto peers = participant.present();
  for (const auto& sample : reports.statuses.take()) {
    const auto peer = peers.find(sample.info.participant);
    if (sample.info.gone)
      view.lose(sample.data.service().to_string(), now);
    else
      view.hear(sample.data, now, peer == peers.end() ? "" : peer->second.middleware);
  }
  std::vector<std::string> refused;
  for (const auto& [name, count] : participant.refused()) refused.push_back(name);
  view.refuse(std::move(refused));
  for (const auto& sample : reports.beacons.take())
    if (!sample.info.gone) view.hear(sample.data, now);
  for (const auto& sample : reports.gates.take())
    if (!sample.info.gone) view.hear(sample.data, now);
}

void clear_terminal() {
  tool::note_interrupts();
  std::cout << "\x1b[2J";
}

}  // namespace

int status_command(const std::vector<std::string>& arguments) {
  CLI::App app{
      "Who is there and how they fare. On a terminal the table is renewed until q and Enter or "
      "Ctrl-C.",
      "prehend status"};
  Arguments given;
  given.add_to(app);
  if (const auto code = service::parse(app, arguments)) return *code;

  const auto config = given.lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  auto participant = dds::Participant::create(service::membership(*config, "prehend", "viewer"));
  if (!participant) return service::complain(participant.error(), exit_broken);
  auto reports = SelfReports::create(*participant);
  if (!reports) return service::complain(reports.error(), exit_broken);

  StatusView view(config->names("lab.services"));
  const auto all_up = [&] {
    return std::all_of(given.awaited.begin(), given.awaited.end(), [&](const std::string& name) {
      const auto times = std::count(given.awaited.begin(), given.awaited.end(), name);
      return view.up(name, process_now()) >= static_cast<std::size_t>(times);
    });
  };
  const bool live =
      !given.json && !given.once && given.awaited.empty() && has_cursor(STDOUT_FILENO);
  if (live) clear_terminal();
  const Time begin = process_now();
  Time next_page = begin + std::chrono::milliseconds(500);
  while (!tool::interrupted()) {
    const Time now = process_now();
    if (!live && now - begin > prehend::seconds(given.timeout)) break;
    if (!given.awaited.empty() && all_up()) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    tell(view, *reports, *participant, now);
    if (!live) continue;
    if (entered_key() == 'q') break;
    if (now < next_page) continue;
    next_page = now + std::chrono::milliseconds(500);
    show("rig " + config->text("lab.rig") + ": " + view.page(now));
  }
  const Time now = process_now();
  if (!live) std::cout << (given.json ? view.json(now) + "\n" : view.page(now));
  if (!given.awaited.empty()) return all_up() ? exit_done : exit_no;
  return view.empty() ? exit_no : exit_done;
}

}  // namespace prehend::cli
