#include "services/cli/tools/demo/stage.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "common/base/file_text.hpp"
#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/model/hand_model.hpp"
#include "services/cli/tools/demo/free_address.hpp"
#include "services/cli/tools/demo/setting.hpp"

namespace prehend::cli {
namespace {

/// The simulated hand of a robot that is emulated.
constexpr const char* twin = "twin";
constexpr const char* hand_is_twin = "simulation.hand_name=twin";

std::string absolute(const std::string& path) {
  return path.empty() || path.find("://") != std::string::npos
             ? path
             : std::filesystem::absolute(path).string();
}

bool in(const std::vector<std::string>& list, std::string_view entry) {
  return std::find(list.begin(), list.end(), entry) != list.end();
}

bool is_serial(const GloveRow& row) {
  return row.line == "serial";
}

/// A hand that the console's page tracks comes as datagrams.
constexpr const char* webcam = "landmarks:127.0.0.1:9870";

}  // namespace

Stage::Source Stage::source_of(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return {text, ""};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

Stage::Stage(const DemoOptions& options, Onlooker& onlooker)
    : options_(options),
      onlooker_(onlooker),
      glove_(source_of(options.glove == "webcam" ? webcam : options.glove)),
      camera_(source_of(options.camera)) {}

bool Stage::glove_has_ended() {
  return lab_ && lab_->ended("glove");
}

/// Up before the others, so that it misses nothing and all can be watched.
Trouble Stage::await_service(const std::string& name) {
  return onlooker_.await(
      "starting", [&] { return onlooker_.seen().is_up(name); },
      [&] {
        return Error{"did not come up", name, ""};
      });
}

Trouble Stage::look_up() {
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

Trouble Stage::look_up_camera() {
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

std::string Stage::hand_setting() const {
  return in(model::hand_names(), options_.hand)
             ? options_.hand
             : absolute(model::hand_directory(options_.hand).string());
}

std::string Stage::arm_setting() const {
  return options_.arm.find('/') == std::string::npos ? options_.arm : absolute(options_.arm);
}

std::vector<std::string> Stage::settings() const {
  // A rig of its own, so that neither other demonstrations nor a real lab are disturbed.
  std::vector<std::string> sets = options_.lab.overrides();
  sets.push_back(fmt::format("lab.rig=demo-{}-{:x}", ::getpid(),
                             std::chrono::system_clock::now().time_since_epoch().count()));
  if (!options_.hand.empty()) {
    sets.push_back("mapping.hand=" + hand_setting());
    sets.push_back("simulation.hand=" + hand_setting());
    sets.push_back("mapping.model=");  // that of the hand
  }
  if (!options_.arm.empty()) sets.push_back("robot.arm=" + arm_setting());
  if (options_.direct) sets.push_back("mapping.intelligent=false");
  sets.push_back("recognition.source=" + camera_.kind);
  if (!camera_.detail.empty()) sets.push_back("recognition.path=" + absolute(camera_.detail));
  sets.push_back("glove.device=" + glove_.kind);
  if (plays_recording()) sets.push_back("glove.file=" + absolute(glove_.detail));
  // The console sends there, too.
  if (glove_row_.line == "udp" && !glove_.detail.empty())
    sets.push_back("glove.port=" + glove_.detail);
  return sets;
}

Trouble Stage::put_up() {
  if (const auto trouble = look_up()) return trouble;
  std::vector<std::string> sets = settings();
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
  if (!plays_recording()) {
    sets.push_back("glove.user=" + scene->demonstrator.user);
    sets.push_back(fmt::format("glove.hand_scale={:.3f}", scene->demonstrator.hand_scale));
  }
  const auto truth_known = camera_row_.synthetic ? std::optional(*scene) : std::nullopt;
  if (const auto trouble = onlooker_.listen(*config, truth_known)) return trouble;

  lab_.emplace(file, sets, folder_->path());
  onlooker_.mind(*lab_, plays_recording() ? "glove" : "");
  const std::string truth = "lab.scene=" + scene_file.string();
  if (!options_.record.empty())
    if (const auto trouble = start_recorder(sets, truth)) return trouble;
  if (const auto trouble = start_services(sets, truth)) return trouble;
  // Nobody reaches before everyone looks.
  if (const auto trouble = onlooker_.await(
          "starting", [&] { return missing().empty(); },
          [&] {
            return Error{missing() + " did not come up", "demo", ""};
          }))
    return trouble;
  return in(options_.without, "glove") ? std::nullopt : start_glove(scene_file, truth);
}

bool Stage::is_ready(const std::string& name) const {
  return onlooker_.seen().is_up(name) &&
         (name != "robot" || onlooker_.seen().has_counted(name, "readings"));
}

/// The robot's driver takes the commands, and the emulated robot at the end of its wire moves the
/// simulated hand, which goes by another name.
Trouble Stage::start_robot(const std::vector<std::string>& sets) {
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
  const auto started = lab_->start_service(
      "robot", {"robot.device=" + robot.detail, "robot.port=" + port, "robot.home=true",
                "robot.lost_after=1", "safety.deadman=false"});
  if (!started) return broken(started.error());
  awaited_.push_back("robot");
  return std::nullopt;
}

Trouble Stage::wait_for_port(const std::string& port, const std::string& name) {
  return onlooker_.await(
      "starting the " + name,
      [&] { return std::filesystem::exists(std::filesystem::symlink_status(port)); },
      [&] {
        return Error{"did not open its port", name, ""};
      });
}

Trouble Stage::start_services(const std::vector<std::string>& sets, const std::string& truth) {
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

Trouble Stage::start_glove(const std::filesystem::path& scene_file, const std::string& truth) {
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

Trouble Stage::emulate(const GloveRow& row, const std::filesystem::path& scene_file,
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

/// Up before the others, so that it misses nothing.
Trouble Stage::start_recorder(std::vector<std::string> sets, const std::string& truth) {
  sets.push_back(truth);
  std::vector<std::string> arguments{"--output", absolute(options_.record), "--quiet", "--config",
                                     options_.lab.file()};
  for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
  if (const auto started = lab_->start("recorder", "prehend-record", arguments); !started)
    return broken(started.error());
  return await_service("recorder");
}

/// Up before the others, so that all can be watched. It says where, as its first line.
Trouble Stage::start_console(const std::string& truth) {
  const auto started = lab_->start_service("console", {truth});
  if (!started) return broken(started.error());
  if (const auto trouble = await_service("console")) return trouble;
  const auto said = read_file(folder_->path() / "console.log");
  const std::size_t at = said ? said->find("http") : std::string::npos;
  if (at != std::string::npos)
    log::info("watch it at {}; Ctrl-C ends it", said->substr(at, said->find('\n', at) - at));
  // Whom the page's buttons for teaching speak to; nobody waits for it.
  const auto teacher = lab_->start_service("teacher");
  return teacher ? std::nullopt : broken(teacher.error());
}

std::string Stage::missing() const {
  std::string names;
  for (const std::string& name : awaited_)
    if (!is_ready(name)) names += (names.empty() ? "" : ", ") + name;
  return names;
}

}  // namespace prehend::cli
