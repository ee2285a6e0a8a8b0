#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>

#include "common/base/file_text.hpp"
#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/service/arguments.hpp"
#include "common/service/membership.hpp"
#include "common/service/shell.hpp"
#include "common/tool/keyboard.hpp"
#include "services/recorder/service/describe.hpp"
#include "services/recorder/service/operator_link.hpp"
#include "services/recorder/service/recorder.hpp"
#include "services/recorder/service/topic_listener.hpp"
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

Time system_now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

/// A recorder at work: topics in, orders in, a file out.
class Recording {
 public:
  Recording(service::Shell& shell, Recorder recorder, const Arguments& arguments)
      : shell_(shell),
        recorder_(std::move(recorder)),
        arguments_(arguments),
        progress_(arguments.quiet || arguments.json),
        operator_(shell, "recorder", [this](const std::string& order) { return execute(order); }) {}

  Expected<void> start() {
    if (arguments_.paused) recorder_.pause(system_now());
    auto keys = keys_of_types();
    if (!keys) return tl::unexpected(keys.error());
    dds::ParticipantOptions lab = service::membership(shell_.config(), "recorder");
    if (!arguments_.rig.empty()) lab.rig = arguments_.rig;
    auto listener =
        TopicListener::create({.lab = std::move(lab),
                               .topics = arguments_.topics,
                               .keys = std::move(*keys),
                               .on_found = [this] { shell_.post([this] { listener_->poll(); }); }},
                              [this](const Source& source, dds::RawSample&& sample) {
                                const std::scoped_lock lock(mutex_);
                                recorder_.take(source, std::move(sample));
                              });
    if (!listener) return tl::unexpected(listener.error());
    listener_ = std::move(*listener);
    started_ = system_now();
    shell_.on_tick(std::chrono::milliseconds(100), [this](Time now) { tick(now); });
    shell_.status().running();
    return {};
  }

  /// After the shell has ended.
  Expected<void> finish() {
    listener_->stop();
    const std::scoped_lock lock(mutex_);
    note_losses();
    const auto closed = recorder_.close();
    progress_.clear();
    return closed;
  }

  std::string report() const {
    nlohmann::ordered_json files = nlohmann::json::array();
    for (const auto& file : recorder_.files()) files.push_back(file.string());
    return nlohmann::ordered_json{{"files", files},
                                  {"messages", recorder_.messages()},
                                  {"bytes", recorder_.bytes()},
                                  {"topics", listener_->topic_count()},
                                  {"lost", recorder_.lost()}}
        .dump();
  }
  std::string summary() const {
    return fmt::format(
        "{} messages on {} topics, {:.1f} MB, {} lost{}", recorder_.messages(),
        listener_->topic_count(), static_cast<double>(recorder_.bytes()) / 1e6, recorder_.lost(),
        recorder_.files().empty() ? "" : ", in " + recorder_.files().back().string());
  }

 private:
  Expected<std::string> execute(const std::string& order) {
    if (order == "stop") {
      shell_.stop();
      return "stopped";
    }
    if (order == "snapshot") return snapshot();
    const std::scoped_lock lock(mutex_);
    if (order == "pause") {
      recorder_.pause(shell_.now());
      return "paused";
    }
    if (order == "start" || order == "resume") {
      recorder_.resume(shell_.now());
      return "recording";
    }
    return fail("unknown order '" + order + "'", "recorder",
                "start, stop, pause, resume or snapshot");
  }

  /// Written without the lock: the disk may take seconds, and samples come on.
  Expected<std::string> snapshot() {
    std::unique_lock lock(mutex_);
    const auto taken = recorder_.snapshot(shell_.now());
    lock.unlock();
    if (!taken) return tl::unexpected(taken.error());
    const auto written = taken->write();
    if (!written) return tl::unexpected(written.error());
    lock.lock();
    recorder_.add(*written);
    return written->path.string();
  }

  void say(const std::string& order) {
    const auto answer = execute(order);
    progress_.clear();
    if (answer)
      log::info("{}", *answer);
    else
      log::warning(answer.error());
  }

  void on_key(int key) {
    if (key == ' ') say(recorder_.paused() ? "resume" : "pause");
    if (key == 's') say("snapshot");
    if (key == 'q') say("stop");
  }

  void note_losses() {
    for (const auto& [topic, count] : listener_->lost()) recorder_.set_lost(topic, count);
  }

  void tick(Time now) {
    listener_->poll();
    while (const auto key = keyboard_.key()) on_key(*key);
    if (std::exchange(wants_snapshot, 0)) say("snapshot");
    if (std::exchange(wants_pause, 0)) say(recorder_.paused() ? "resume" : "pause");
    {
      const std::scoped_lock lock(mutex_);
      note_losses();
      recorder_.tick(now);
      if (recorder_.error()) shell_.stop(exit_broken);
      shell_.status().count("messages", recorder_.messages() - counted_);
      counted_ = recorder_.messages();
      if (const auto lost = recorder_.lost(); lost > lost_) {
        shell_.status().drop("not recorded", lost - lost_);
        lost_ = lost;
      }
      const double elapsed = to_seconds(now - started_);
      progress_.show(fmt::format(
          "{} {:.0f} s  {} topics  {} messages  {:.1f} MB{}  {} lost",
          recorder_.paused() ? "paused" : "recording", elapsed, listener_->topic_count(),
          recorder_.messages(), static_cast<double>(recorder_.bytes()) / 1e6,
          arguments_.snapshot > 0
              ? fmt::format("  {:.1f} MB kept", static_cast<double>(recorder_.ring_bytes()) / 1e6)
              : "",
          recorder_.lost()));
    }
    if (arguments_.duration > 0 && now - started_ >= seconds(arguments_.duration)) shell_.stop();
  }

  service::Shell& shell_;
  std::mutex mutex_;  // guards the recorder, which the listener's thread feeds
  Recorder recorder_;
  const Arguments& arguments_;
  ProgressLine progress_;
  tool::Keyboard keyboard_;
  OperatorLink operator_;
  Time started_{};
  std::uint64_t counted_ = 0, lost_ = 0;
  std::unique_ptr<TopicListener> listener_;  // last: its thread uses the rest
};

int record(const Arguments& arguments) {
  std::signal(SIGUSR1, [](int) { wants_snapshot = 1; });
  std::signal(SIGUSR2, [](int) { wants_pause = 1; });
  // A limit of the file's size shall be an error like a full disk, not the end of the process.
  std::signal(SIGXFSZ, SIG_IGN);

  auto joined = service::Shell::create(arguments.lab.for_service(),
                                       {"recorder", "Records topics.", {}, false});
  if (!joined) return service::complain(joined.error());
  const std::unique_ptr<service::Shell> shell = std::move(*joined);

  auto describe = describe_types(arguments.schema);
  if (!describe) return service::complain(describe.error(), exit_broken);
  Heading heading{shell->config().texts(), "", std::move(*describe)};
  if (const auto file = shell->config().path("lab.scene"); !file.empty()) {
    auto scene = read_file(file, "see lab.scene");
    if (!scene) return service::complain(scene.error(), exit_wrong_use);
    heading.scene = std::move(*scene);
  }
  const RecorderOptions options = arguments.recorder();
  std::error_code code;
  if (std::filesystem::exists(options.file, code)) {
    if (!arguments.force)
      return service::complain(
          {"is there already", options.file.string(), "choose another name, or give --force"},
          exit_wrong_use);
    std::filesystem::remove(options.file, code);
  }
  auto recorder = Recorder::create(options, heading, system_now());
  if (!recorder) return service::complain(recorder.error(), exit_broken);

  Recording recording(*shell, std::move(*recorder), arguments);
  if (const auto started = recording.start(); !started)
    return service::complain(started.error(), exit_broken);
  const auto ended = shell->run();
  if (!ended) return service::complain(ended.error());
  const auto finished = recording.finish();
  if (!finished) log::error(finished.error());
  log::info("{}", recording.summary());
  if (arguments.json) std::cout << recording.report() << "\n";
  return finished ? *ended : exit_broken;
}

int run(const std::vector<std::string>& texts) {
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

}  // namespace
}  // namespace prehend::recorder

int main(int argc, char** argv) {
  return prehend::recorder::run({argv + 1, argv + argc});
}
