#include "services/cli/tools/demo_command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <iostream>
#include <thread>

#include "common/arm/mounting.hpp"
#include "common/base/file_text.hpp"
#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/model/arm_choice.hpp"
#include "common/model/hand_model.hpp"
#include "common/service/lab.hpp"
#include "services/cli/service/listener.hpp"
#include "services/cli/service/observer.hpp"
#include "services/cli/tools/dispatch.hpp"
#include "services/cli/tools/free_address.hpp"
#include "services/cli/tools/rows.hpp"
#include "services/cli/tools/series.hpp"
#include "services/cli/tools/setting.hpp"

namespace prehend::cli {
namespace {

using Clock = std::chrono::steady_clock;

/// The simulated hand of a robot that is emulated.
constexpr const char* twin = "twin";
constexpr const char* hand_is_twin = "simulation.hand_name=twin";

volatile std::sig_atomic_t interrupted = 0;

/// Ctrl-C ends the demonstration, not this program at once, so that the services are stopped.
void watch_for_interrupts() {
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = 1; };
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) ::sigaction(number, &action, nullptr);
}

/// KIND[:DETAIL]
struct Source {
  std::string kind, detail;
};
Source source_of(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return {text, ""};
  return {text.substr(0, colon), text.substr(colon + 1)};
}
std::string absolute(const std::string& path) {
  return path.empty() || path.find("://") != std::string::npos
             ? path
             : std::filesystem::absolute(path).string();
}

bool in(const std::vector<std::string>& list, std::string_view entry) {
  return std::find(list.begin(), list.end(), entry) != list.end();
}

/// A hand that the console's page tracks comes as datagrams.
constexpr const char* webcam = "landmarks:127.0.0.1:9870";

/// One demonstration from start to end.
class Demonstration {
 public:
  Demonstration(const DemoOptions& options, const Progress& progress)
      : options_(options),
        progress_(progress),
        glove_(source_of(options.glove == "webcam" ? webcam : options.glove)),
        camera_(source_of(options.camera)) {}

  tl::expected<Outcome, Failure> run() {
    const auto start = Clock::now();
    end_ = start + std::chrono::duration_cast<Clock::duration>(seconds(options_.timeout));
    if (const auto error = options_.attach ? attach() : start_lab()) return tl::unexpected(*error);
    const auto glove_start = Clock::now();
    const std::string reason = watch();
    if (failure_) return tl::unexpected(*failure_);
    Outcome outcome = observer_.outcome();
    outcome.seconds = to_seconds(Clock::now() - glove_start);
    if (!outcome.judged) outcome.grasp.reason = reason;
    if (outcome.device.empty()) outcome.device = glove_.kind;
    if (outcome.hand.empty()) outcome.hand = hand_;
    if (options_.watch) {
      options_.on_outcome(outcome);
      while (!step("watching")) {
      }
    }
    return outcome;
  }

 private:
  using Trouble = std::optional<Failure>;

  Trouble wrong(const Error& error) { return Failure{error, exit_wrong_use}; }
  Trouble broken(const Error& error) { return Failure{error, exit_broken}; }

  Trouble listen(const service::Config& config) {
    if (const auto trouble = expect_arm(config)) return trouble;
    auto listener = Listener::create(config, true);
    if (!listener) return broken(listener.error());
    listener_.emplace(std::move(*listener));
    return std::nullopt;
  }

  Trouble expect_arm(const service::Config& config) {
    const std::string& name = config.text("robot.arm");
    if (name.empty()) return std::nullopt;
    const auto arm = model::load_arm(name);
    if (!arm) return wrong(arm.error());
    std::vector<double> speeds;
    for (const model::ArmJoint& joint : arm->joints) speeds.push_back(joint.velocity);
    observer_.expect_arm(arm->name, speeds);
    const auto hand = model::HandModel::load(model::hand_directory(config.text("simulation.hand")));
    if (!hand) return wrong(hand.error());
    if (const auto fits = arm::check_fit(*arm, *hand); !fits) return wrong(fits.error());
    return std::nullopt;
  }

  Trouble attach() {
    const auto config = options_.lab.load();
    if (!config) return wrong(config.error());
    const std::filesystem::path file = config->path("lab.scene");
    if (!file.empty()) {
      const auto catalogue = model::Catalogue::load(config->path("lab.catalogue"));
      if (!catalogue) return broken(catalogue.error());
      auto scene = model::load_scene(file, *catalogue);
      if (!scene) return broken(scene.error());
      observer_ = Observer(*scene);
    }
    return listen(*config);
  }

  /// Asks the services what the glove and the camera are that were named.
  Trouble look_up() {
    const auto gloves = ask_glove_rows();
    if (!gloves) return broken(gloves.error());
    gloves_ = *gloves;
    if (glove_.kind.empty()) {
      const auto first = std::find_if(gloves_.begin(), gloves_.end(),
                                      [](const GloveRow& row) { return row.emulator; });
      glove_.kind = first == gloves_.end() ? gloves_.front().name : first->name;
    }
    auto glove = find_row(gloves_, glove_.kind, "--glove");
    if (!glove) return wrong(glove.error());
    glove_row_ = *glove;
    return look_up_camera();
  }

  Trouble look_up_camera() {
    // Where nobody looks, nothing says otherwise than the scene, and no camera need be installed.
    camera_row_.synthetic = true;
    if (in(options_.without, "recognition")) return std::nullopt;
    const auto cameras = ask_camera_rows();
    if (!cameras) return broken(cameras.error());
    if (camera_.kind.empty()) camera_.kind = cameras->front().name;
    const auto camera = find_row(*cameras, camera_.kind, "--camera");
    if (!camera) return wrong(camera.error());
    camera_row_ = *camera;
    return std::nullopt;
  }

  /// Services may run in other folders.
  std::string arm_setting() const {
    return options_.arm.find('/') == std::string::npos ? options_.arm : absolute(options_.arm);
  }

  bool plays_file() const { return glove_row_.line == "file"; }

  Trouble start_lab() {
    if (const auto trouble = look_up()) return trouble;
    // A rig of its own, so that neither other demonstrations nor a real lab are disturbed.
    std::vector<std::string> sets = options_.lab.overrides();
    sets.push_back(fmt::format("lab.rig=demo-{}-{:x}", ::getpid(),
                               std::chrono::system_clock::now().time_since_epoch().count()));
    if (!options_.hand.empty()) {
      sets.push_back("mapping.hand=" + options_.hand);
      sets.push_back("simulation.hand=" + options_.hand);
      sets.push_back("mapping.model=");  // that of the hand
    }
    if (!options_.arm.empty()) sets.push_back("robot.arm=" + arm_setting());
    if (options_.direct) sets.push_back("mapping.intelligent=false");
    sets.push_back("recognition.source=" + camera_.kind);
    if (!camera_.detail.empty()) sets.push_back("recognition.path=" + absolute(camera_.detail));
    sets.push_back("glove.device=" + glove_.kind);
    if (plays_file()) sets.push_back("glove.file=" + absolute(glove_.detail));
    // The console sends there, too.
    if (glove_row_.line == "udp" && !glove_.detail.empty())
      sets.push_back("glove.port=" + glove_.detail);

    const std::string file = options_.lab.file();
    const auto config = service::Config::load(file, sets);
    if (!config) return wrong(config.error());
    hand_ = config->text("simulation.hand");

    auto folder = service::TemporaryFolder::create(options_.keep);
    if (!folder) return broken(folder.error());
    folder_.emplace(std::move(*folder));
    if (options_.keep) log::info("scene and logs are in {}", folder_->path().string());

    // The truth: the synthetic camera renders it, the synthetic hand reaches into it.
    const auto scene = make_setting({options_.seed, options_.object, model::hand_directory(hand_),
                                     config->path("lab.catalogue")});
    if (!scene) return wrong(scene.error());
    const std::filesystem::path scene_file = folder_->path() / "scene.toml";
    if (const auto written = write_setting(*scene, scene_file); !written)
      return broken(written.error());
    observer_ = camera_row_.synthetic ? Observer(*scene) : Observer();
    if (!plays_file()) {
      sets.push_back("glove.user=" + scene->demonstrator.user);
      sets.push_back(fmt::format("glove.hand_scale={:.3f}", scene->demonstrator.hand_scale));
    }
    if (const auto trouble = listen(*config)) return trouble;

    lab_.emplace(file, sets, folder_->path());
    const std::string truth = "lab.scene=" + scene_file.string();
    if (!options_.record.empty())
      if (const auto trouble = start_recorder(sets, truth)) return trouble;
    if (const auto trouble = start_services(sets, truth)) return trouble;
    // Nobody reaches before everyone looks.
    while (!std::all_of(awaited_.begin(), awaited_.end(),
                        [&](const std::string& name) { return is_ready(name); })) {
      if (const auto trouble = step("starting")) return trouble;
      if (Clock::now() >= end_) return broken({missing() + " did not come up", "demo", ""});
    }
    return in(options_.without, "glove") ? std::nullopt : start_glove(scene_file, truth);
  }

  /// A robot says something of its joints only when it is homed and follows.
  bool is_ready(const std::string& name) const {
    return observer_.is_up(name) && (name != "robot" || observer_.has_counted(name, "readings"));
  }

  /// The robot's driver takes the commands, and the emulated robot at the end of its wire moves the
  /// simulated hand, which goes by another name.
  Trouble start_robot(const std::vector<std::string>& sets) {
    const Source robot = source_of(options_.robot);
    if (robot.kind != "emulated" || robot.detail.empty())
      return wrong({"is not emulated:DEVICE", "--robot " + options_.robot, ""});
    const std::string port = (folder_->path() / "robot_port").string();
    std::vector<std::string> arguments{
        "emulate", "--device", robot.detail, "--hand",           hand_, "--link", port,
        "--twin",  twin,       "--config",   options_.lab.file()};
    for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
    const std::string name = "emulated " + robot.detail;
    if (const auto started = lab_->start(name, "prehend-robot-tool", arguments); !started)
      return broken(started.error());
    if (const auto trouble = wait_for_port(port, name)) return trouble;
    // Who emulates shares the processors with everybody, and may have to wait for them.
    const auto started =
        lab_->start_service("robot", {"robot.device=" + robot.detail, "robot.port=" + port,
                                      "robot.home=true", "robot.lost_after=1"});
    if (!started) return broken(started.error());
    awaited_.push_back("robot");
    return std::nullopt;
  }

  Trouble wait_for_port(const std::string& port, const std::string& name) {
    while (!std::filesystem::exists(std::filesystem::symlink_status(port))) {
      if (const auto trouble = step("starting the " + name)) return trouble;
      if (Clock::now() >= end_) return broken({"did not open its port", name, ""});
    }
    return std::nullopt;
  }

  Trouble start_services(const std::vector<std::string>& sets, const std::string& truth) {
    if (options_.watch)
      if (const auto trouble = start_console(truth)) return trouble;
    for (const std::string service : {"recognition", "mapping", "simulation"}) {
      if (in(options_.without, service)) continue;
      // A real camera sees a table that nobody described: the world is built from what it sees.
      const bool told = camera_row_.synthetic || service != "simulation";
      std::vector<std::string> own{told ? truth : std::string("lab.scene=")};
      if (service == "simulation" && !options_.robot.empty()) own.push_back(hand_is_twin);
      const auto started = lab_->start_service(service, own);
      if (!started) return broken(started.error());
      awaited_.push_back(service);
    }
    return options_.robot.empty() ? std::nullopt : start_robot(sets);
  }

  Trouble start_glove(const std::filesystem::path& scene_file, const std::string& truth) {
    std::vector<std::string> sets{truth};
    if (glove_row_.emulator) {
      const bool serial = is_serial(glove_row_);
      std::string port = serial ? absolute(glove_.detail) : glove_.detail;
      if (port.empty()) {
        port = serial ? (folder_->path() / "glove_port").string() : free_address();
        if (const auto trouble = emulate(glove_row_, scene_file, port, {})) return trouble;
        if (!glove_row_.tracker.empty()) {
          // The glove measures only joints: a tracker on its back says where the hand is.
          const std::string wrist = (folder_->path() / "wrist_port").string();
          const auto tracker = find_row(gloves_, glove_row_.tracker, glove_row_.name);
          if (!tracker) return broken(tracker.error());
          if (const auto trouble =
                  emulate(*tracker, scene_file, wrist, {"glove.sites=[\"back_of_hand\"]"}))
            return trouble;
          sets.push_back("glove.wrist_port=" + wrist);
        }
      }
      sets.push_back("glove.port=" + port);
    }
    const auto started = lab_->start_service("glove", sets);
    if (!started) return broken(started.error());
    return std::nullopt;
  }

  /// Starts a device that is not there, and waits until it is plugged in.
  Trouble emulate(const GloveRow& row, const std::filesystem::path& scene_file,
                  const std::string& port, std::vector<std::string> sets) {
    const std::string& kind = row.name;
    const bool serial = is_serial(row);
    std::vector<std::string> arguments{
        "emulate", "--kind", kind, "--scene", scene_file.string(), "--config", options_.lab.file()};
    if (serial)
      arguments.insert(arguments.end(), {"--link", port});
    else
      sets.push_back("glove.port=" + port);
    for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
    const auto started = lab_->start("emulated " + kind, "prehend-glove-tool", arguments);
    if (!started) return broken(started.error());
    return serial ? wait_for_port(port, "emulated " + kind) : std::nullopt;
  }

  static bool is_serial(const GloveRow& row) { return row.line == "serial"; }

  /// Of this machine, for datagrams; that somebody else has it is as good as impossible.
  /// Up before the others, so that it misses nothing.
  Trouble start_recorder(std::vector<std::string> sets, const std::string& truth) {
    sets.push_back(truth);
    std::vector<std::string> arguments{"--output", absolute(options_.record), "--quiet", "--config",
                                       options_.lab.file()};
    for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
    if (const auto started = lab_->start("recorder", "prehend-record", arguments); !started)
      return broken(started.error());
    while (!observer_.is_up("recorder")) {
      if (const auto trouble = step("starting")) return trouble;
      if (Clock::now() >= end_) return broken({"did not come up", "recorder", ""});
    }
    return std::nullopt;
  }

  /// Up before the others, so that all can be watched. It says where, as its first line.
  Trouble start_console(const std::string& truth) {
    const auto started = lab_->start_service("console", {truth});
    if (!started) return broken(started.error());
    while (!observer_.is_up("console")) {
      if (const auto trouble = step("starting")) return trouble;
      if (Clock::now() >= end_) return broken({"did not come up", "console", ""});
    }
    const auto said = read_file(folder_->path() / "console.log");
    const std::size_t at = said ? said->find("http") : std::string::npos;
    if (at != std::string::npos)
      log::info("watch it at {}; Ctrl-C ends it", said->substr(at, said->find('\n', at) - at));
    return std::nullopt;
  }

  std::string missing() const {
    std::string names;
    for (const std::string& name : awaited_)
      if (!is_ready(name)) names += (names.empty() ? "" : ", ") + name;
    return names;
  }

  /// Listens a moment. Trouble: a process died, or somebody pressed Ctrl-C.
  Trouble step(const std::string& what) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    listener_->poll(observer_);
    progress_(fmt::format("{:<12} {}", what, observer_.progress()));
    if (interrupted) return Failure{{"interrupted", "demo", ""}, exit_no};
    if (lab_)
      if (const auto casualty = lab_->casualty(playing_recording() ? "glove" : ""))
        return broken(*casualty);
    return std::nullopt;
  }

  bool playing_recording() const { return plays_file() && !options_.attach; }

  /// Until the first grasp is judged and everyone has told the figures; a recording is played to
  /// its end. Returns why nothing was judged.
  std::string watch() {
    std::uint64_t frames = 0;
    auto news = Clock::now();
    std::optional<Clock::time_point> judged;
    while (true) {
      if ((failure_ = step(judged ? "judged" : observer_.commanded() ? "reaching" : "waiting")))
        return "";
      const auto now = Clock::now();
      if (observer_.frames() != frames) {
        frames = observer_.frames();
        news = now;
      }
      if (!judged && observer_.judged()) judged = now;
      // The status comes once a second; the judge needs a moment after the last frame.
      const bool silent = now - news > std::chrono::milliseconds(2500);
      const bool over = !playing_recording() || (frames > 0 && silent) ||
                        (frames > 0 && lab_ && lab_->ended("glove"));
      const bool settled =
          judged && (observer_.latency_is_in() || now - *judged > std::chrono::milliseconds(2500));
      if (settled && over) return "";
      if (playing_recording() && frames > 0 && silent && !judged)
        return "the recording ended before a grasp was closed";
      if (now >= end_)
        return frames == 0 ? fmt::format("no glove frame within {:.0f} s", options_.timeout)
                           : fmt::format("no grasp was closed within {:.0f} s", options_.timeout);
    }
  }

  const DemoOptions& options_;
  const Progress& progress_;
  Source glove_, camera_;
  std::vector<GloveRow> gloves_;  // that there are
  GloveRow glove_row_;
  CameraRow camera_row_;
  std::string hand_;
  Clock::time_point end_;
  Observer observer_;
  std::optional<service::TemporaryFolder> folder_;
  std::optional<Listener> listener_;
  std::optional<service::Lab> lab_;  // after the folder: stopped before it is removed
  std::vector<std::string> awaited_;
  Trouble failure_;
};

/// One line that is renewed on a terminal; otherwise a line whenever there is news, but not often.
class Screen {
 public:
  explicit Screen(bool quiet)
      : quiet_(quiet || log::format() == log::Format::json),
        terminal_(::isatty(STDERR_FILENO) != 0) {}
  ~Screen() { clear(); }

  void show(const std::string& text) {
    const auto now = Clock::now();
    if (quiet_ || text == last_ ||
        now - shown_ < (terminal_ ? std::chrono::milliseconds(100) : std::chrono::seconds(2)))
      return;
    last_ = text;
    shown_ = now;
    if (terminal_)
      fmt::print(stderr, "\r\033[K{}", text.substr(0, 100));
    else
      fmt::print(stderr, "{}\n", text);
    std::fflush(stderr);
  }
  void clear() {
    if (!quiet_ && terminal_ && !last_.empty()) fmt::print(stderr, "\r\033[K");
    last_.clear();
  }

 private:
  bool quiet_, terminal_;
  std::string last_;
  Clock::time_point shown_{};
};

/// "A..B" or "A" as seeds.
bool read_range(const std::string& text, SeriesOptions& series) {
  unsigned long long first = 0, last = 0;
  int used = 0;
  const int length = static_cast<int>(text.size());
  if (std::sscanf(text.c_str(), "%llu..%llu%n", &first, &last, &used) != 2 || used != length) {
    if (std::sscanf(text.c_str(), "%llu%n", &first, &used) != 1 || used != length) return false;
    last = first;
  }
  series.first = first;
  series.last = last;
  return first <= last && last - first < 10000;
}

/// Tasks are shown to other services, and judged otherwise: by a tool of those.
bool is_about_task(const std::vector<std::string>& arguments) {
  return std::any_of(arguments.begin(), arguments.end(), [](const std::string& argument) {
    return argument == "--task" || argument.starts_with("--task=");
  });
}

int demonstrate_task(const std::vector<std::string>& arguments) {
  std::vector<std::string> command{"demo"};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return become({"tasks", "prehend-tasks", ""}, command);
}

/// What measures, sees and moves.
void add_devices(CLI::App& app, DemoOptions& demo) {
  app.add_option(
      "--glove", demo.glove,
      "DEVICE[:PORT or FILE], see `prehend glove devices`: what has an emulator is\n"
      "emulated unless a port is given, HOST:PORT for datagrams; webcam: your own hand, by\n"
      "the page of --watch");
  app.add_option("--camera", demo.camera, "SOURCE[:PATH], see `prehend camera sources`");
  auto* robot =
      app.add_option("--robot", demo.robot,
                     "emulated:DEVICE, see `prehend robot emulate`: its driver moves the hand");
  app.add_option("--arm", demo.arm, "the arm that carries the hand, a name or folder: puma560")
      ->excludes(robot);
}

/// For the help: who uses it gets another one.
void add_task(CLI::App& app) {
  app.add_option("--task",
                 "a task (pick-and-place), or a file of one: it is shown, and done again "
                 "elsewhere;\nprehend demo --task pick-and-place --help tells more");
}

}  // namespace

tl::expected<Outcome, Failure> demonstrate(const DemoOptions& options, const Progress& progress) {
  watch_for_interrupts();
  return Demonstration(options, progress).run();
}

// Long: one option after the other.
int demo_command(const std::vector<std::string>& arguments) {
  if (is_about_task(arguments)) return demonstrate_task(arguments);
  CLI::App app{
      "Starts glove, recognition, mapping and simulation as processes on this machine, plays a\n"
      "demonstration through them and says what was grasped and how well. Exit code 0: held,\n"
      "1: not held, 2: wrong use, 3: the environment is broken.",
      "prehend demo"};
  DemoOptions demo;
  SeriesOptions series;
  bool json = false, quiet = false;
  std::string mode, seeds;
  demo.lab.add_to(app);
  auto* seed = app.add_option("--seed", demo.seed, "draws object, poses, light, person and noise");
  app.add_option("--object", demo.object, "the object that is reached for");
  app.add_option("--hand", demo.hand, "the robot hand");
  app.add_option("--without", demo.without, "a service that is left out; may be repeated")
      ->check(CLI::IsMember({"glove", "recognition", "mapping", "simulation"}))
      ->type_size(1)
      ->allow_extra_args(false);
  add_devices(app, demo);
  app.add_option("--mode", mode, "direct: the mapping does not use what is recognised")
      ->check(CLI::IsMember({"direct", "intelligent"}));
  app.add_option("--timeout", demo.timeout, "s until it ends without a grasp")
      ->check(CLI::Range(1.0, 3600.0));
  app.add_option("--record", demo.record, "record all topics into this file");
  add_task(app);
  auto* watch =
      app.add_flag("--watch", demo.watch, "with a page that shows it (console.port), until Ctrl-C");
  app.add_flag("--attach", demo.attach, "start nothing, judge the lab that runs")->excludes(watch);
  app.add_flag("--keep", demo.keep, "keep scene and logs");
  app.add_flag("--json", json, "one JSON document on standard output");
  app.add_flag("--quiet", quiet, "no progress");
  app.add_option("--seeds", seeds, "A..B: a table over several seeds")->excludes(seed, watch);
  app.add_flag("--compare-direct", series.compare_direct,
               "with --seeds: each once more with direct mapping");
  if (const auto code = parse(app, arguments)) return *code;
  demo.direct = mode == "direct";

  Screen screen(quiet);
  const Progress progress = [&screen](const std::string& text) { screen.show(text); };
  if (!seeds.empty()) {
    series.json = json;
    if (!read_range(seeds, series))
      return complain({"must be A..B", "--seeds " + seeds, ""}, exit_wrong_use);
    return run_series(demo, series, progress);
  }
  const auto show = [&](const Outcome& outcome) {
    screen.clear();
    std::cout << (json ? to_json(outcome) + "\n" : to_table(outcome)) << std::flush;
  };
  if (demo.watch) demo.on_outcome = show;
  const auto outcome = demonstrate(demo, progress);
  screen.clear();
  if (!outcome) return complain(outcome.error().error, outcome.error().exit_code);
  if (!demo.watch) show(*outcome);
  return outcome->grasp.held ? exit_done : exit_no;
}

}  // namespace prehend::cli
