#include "services/recorder/tools/record/record_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/base/clock.hpp"
#include "common/base/file_text.hpp"
#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/service/arguments.hpp"
#include "common/service/shell.hpp"
#include "common/tool/keyboard.hpp"
#include "services/recorder/service/describe.hpp"
#include "services/recorder/service/recorder_service.hpp"
#include "services/recorder/tools/terminal/progress_line.hpp"

namespace prehend::recorder {
namespace {

volatile std::sig_atomic_t wants_snapshot = 0, wants_pause = 0;

struct Arguments {
  service::LabArguments lab;
  std::string output, schema = "ros2msg", compression = "zstd", rig;
  TopicFilter topics;
  double split_mb = 4000, split_time = 6 * 3600, keep_free_mb = 200, snapshot = 0,
         snapshot_mb = 512, duration = 0;
  int keep = 0;
  bool paused = false, force = false, json = false, quiet = false;

  void add_to(CLI::App& app) {
    lab.add_to(app);
    app.add_option("topics", topics.include, "topics, or patterns like 'robot/*'; none: all");
    app.add_option("-o,--output", output, "the file to write, NAME.mcap")->required();
    app.add_option("-x,--exclude", topics.exclude, "topics or patterns to leave out; repeatable")
        ->type_size(1)
        ->allow_extra_args(false);
    app.add_option("--rig", rig, "another rig than lab.rig, or a pattern; '*': all");
    app.add_option("--split-size", split_mb, "MB after which the next file begins")
        ->check(CLI::Range(0.001, 1e9));
    app.add_option("--split-time", split_time, "s after which the next file begins")
        ->check(CLI::Range(0.1, 1e6));
    app.add_option("--keep", keep, "keep only so many of the newest files")
        ->check(CLI::Range(1, 1000000));
    app.add_option("--keep-free", keep_free_mb, "MB of the disk that are left free")
        ->check(CLI::Range(0.0, 1e9));
    app.add_option("--snapshot", snapshot,
                   "keep the last so many s in memory, and write them on request")
        ->check(CLI::Range(0.1, 86400.0));
    app.add_option("--snapshot-size", snapshot_mb, "MB of memory for that")
        ->check(CLI::Range(1.0, 1e6));
    app.add_option("--duration", duration, "s until it stops by itself")
        ->check(CLI::Range(0.1, 1e7));
    app.add_option("--schema", schema, "how types are described")
        ->check(CLI::IsMember({"ros2msg", "omgidl"}));
    app.add_option("--compression", compression, "of the chunks")
        ->check(CLI::IsMember({"zstd", "lz4", "none"}));
    app.add_flag("--paused", paused, "wait for the order to start");
    app.add_flag("--force", force, "write over a file that is there");
    app.add_flag("--json", json, "at the end, one JSON document on standard output");
    app.add_flag("--quiet", quiet, "no progress");
  }

  RecorderOptions recorder() const {
    RecorderOptions options;
    options.file = output;
    options.split_bytes = static_cast<std::uint64_t>(split_mb * 1e6);
    options.split_time = seconds(split_time);
    options.keep_files = keep;
    options.keep_free = static_cast<std::uint64_t>(keep_free_mb * 1e6);
    options.snapshot = seconds(snapshot);
    options.snapshot_bytes = static_cast<std::uint64_t>(snapshot_mb * 1e6);
    options.compression =
        *recording::mcap::compression_named(compression == "none" ? std::string() : compression);
    return options;
  }
};

/// Keys, signals and a line of progress for who sits before the recorder.
class RecorderTerminal {
 public:
  RecorderTerminal(bool quiet, bool with_ring) : progress_(quiet), with_ring_(with_ring) {}

  void tick(RecorderService& service) {
    while (const auto key = keyboard_.key()) on_key(service, *key);
    if (std::exchange(wants_snapshot, 0)) say(service, "snapshot");
    if (std::exchange(wants_pause, 0)) toggle(service);
    const RecorderService::Stats stats = service.stats();
    progress_.show(
        fmt::format("{} {:.0f} s  {} topics  {} messages  {:.1f} MB{}  {} lost",
                    stats.paused ? "paused" : "recording", stats.elapsed_s, stats.topics,
                    stats.messages, megabytes(stats.bytes),
                    with_ring_ ? fmt::format("  {:.1f} MB kept", megabytes(stats.ring_bytes)) : "",
                    stats.lost));
  }
  void clear() { progress_.clear(); }

  static double megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) / 1e6; }

 private:
  void on_key(RecorderService& service, int key) {
    if (key == ' ') toggle(service);
    if (key == 's') say(service, "snapshot");
    if (key == 'q') say(service, "stop");
  }

  void toggle(RecorderService& service) {
    say(service, service.stats().paused ? "resume" : "pause");
  }

  void say(RecorderService& service, const std::string& order) {
    const auto answer = service.execute(order);
    progress_.clear();
    if (answer)
      log::info("{}", *answer);
    else
      log::warning(answer.error());
  }

  ProgressLine progress_;
  bool with_ring_;
  tool::Keyboard keyboard_;
};

std::string report(const RecorderService& service) {
  const RecorderService::Stats stats = service.stats();
  nlohmann::ordered_json files = nlohmann::json::array();
  for (const auto& file : service.recorder().files()) files.push_back(file.string());
  return nlohmann::ordered_json{{"files", files},
                                {"messages", stats.messages},
                                {"bytes", stats.bytes},
                                {"topics", stats.topics},
                                {"lost", stats.lost}}
      .dump();
}

std::string summary(const RecorderService& service) {
  const RecorderService::Stats stats = service.stats();
  const auto& files = service.recorder().files();
  return fmt::format("{} messages on {} topics, {:.1f} MB, {} lost{}", stats.messages, stats.topics,
                     RecorderTerminal::megabytes(stats.bytes), stats.lost,
                     files.empty() ? "" : ", in " + files.back().string());
}

/// What the head of each file says beside its topics.
Expected<Heading> heading_of(const service::Config& lab, const std::string& schema) {
  auto describe = describe_types(schema);
  if (!describe) return tl::unexpected(describe.error());
  Heading heading{lab.texts(), "", std::move(*describe)};
  const bool own_catalogue = !lab.text("lab.catalogue").starts_with("share:");
  for (auto [key, text] : {std::pair("lab.scene", &heading.scene),
                           std::pair(own_catalogue ? "lab.catalogue" : "", &heading.catalogue)}) {
    const auto file = *key ? lab.path(key) : std::filesystem::path();
    if (file.empty()) continue;
    auto read = read_file(file, std::string("see ") + key);
    if (!read) {
      read.error().exit = exit_wrong_use;
      return tl::unexpected(read.error());
    }
    *text = std::move(*read);
  }
  return heading;
}

/// A file that is there already is written over only if that was asked for.
Expected<void> make_room(const std::filesystem::path& file, bool force) {
  std::error_code code;
  if (!std::filesystem::exists(file, code)) return {};
  if (!force)
    return wrong_use("is there already", file.string(), "choose another name, or give --force");
  std::filesystem::remove(file, code);
  return {};
}

int record(const Arguments& arguments) {
  std::signal(SIGUSR1, [](int) { wants_snapshot = 1; });
  std::signal(SIGUSR2, [](int) { wants_pause = 1; });
  // A limit of the file's size shall be an error like a full disk, not the end of the process.
  std::signal(SIGXFSZ, SIG_IGN);

  auto joined = service::Shell::create(arguments.lab.for_service(),
                                       {"recorder", "Records topics.", {}, false});
  if (!joined) return service::complain(joined.error());
  const std::unique_ptr<service::Shell> shell = std::move(*joined);

  const auto heading = heading_of(shell->config(), arguments.schema);
  if (!heading) return service::complain(heading.error());
  const RecorderOptions options = arguments.recorder();
  if (const auto room = make_room(options.file, arguments.force); !room)
    return service::complain(room.error());
  auto recorder = Recorder::create(options, *heading, process_now());
  if (!recorder) return service::complain(recorder.error(), exit_broken);

  RecorderTerminal terminal(arguments.quiet || arguments.json, arguments.snapshot > 0);
  std::unique_ptr<RecorderService> service;
  auto created = RecorderService::create(*shell, std::move(*recorder),
                                         {.topics = arguments.topics,
                                          .rig = arguments.rig,
                                          .duration = seconds(arguments.duration),
                                          .paused = arguments.paused,
                                          .on_tick = [&] { terminal.tick(*service); }});
  if (!created) return service::complain(created.error(), exit_broken);
  service = std::move(*created);
  const auto ended = shell->run();
  if (!ended) return service::complain(ended.error());
  const auto finished = service->finish();
  terminal.clear();
  if (!finished) log::error(finished.error());
  log::info("{}", summary(*service));
  if (arguments.json) std::cout << report(*service) << "\n";
  return finished ? *ended : exit_broken;
}

}  // namespace

int record_command(const std::vector<std::string>& texts) {
  CLI::App app{
      "Records topics into an MCAP file: all of a rig, also those that come later.\n"
      "Keys: space pauses and resumes, s writes a snapshot, q stops. Signals: USR1 snapshot,\n"
      "USR2 pause or resume, INT or TERM stop. By topic: operator/command, target recorder,\n"
      "argument start, pause, resume, snapshot or stop. Exit code 0: done, 2: wrong use,\n"
      "3: the recording had to end (full disk).",
      "prehend record"};
  Arguments arguments;
  arguments.add_to(app);
  if (const auto code = service::parse(app, texts)) return *code;
  return record(arguments);
}

}  // namespace prehend::recorder
