#include "services/cli/tools/demo/grasp_play.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/log.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/hand_model.hpp"
#include "common/stage/arm.hpp"
#include "services/cli/tools/demo/chosen_hand.hpp"
#include "services/cli/tools/demo/emulated_glove.hpp"
#include "services/cli/tools/demo/page.hpp"
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

/// A hand that the console's page tracks comes as datagrams.
constexpr const char* webcam = "landmarks:127.0.0.1:9870";

tl::unexpected<Error> wrong(Error error) {
  error.exit = exit_wrong_use;
  return tl::unexpected(std::move(error));
}
tl::unexpected<Error> broken(Error error) {
  error.exit = exit_broken;
  return tl::unexpected(std::move(error));
}

}  // namespace

GraspPlay::Source GraspPlay::source_of(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return {text, ""};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

GraspPlay::GraspPlay(const DemoOptions& options, stage::Stage& stage)
    : options_(options),
      stage_(stage),
      glove_(source_of(options.glove == "webcam" ? webcam : options.glove)),
      camera_(source_of(options.camera)) {}

// --- what is chosen

Expected<void> GraspPlay::look_up() {
  const auto gloves = ask_glove_rows();
  if (!gloves) return broken(gloves.error());
  gloves_ = *gloves;
  auto glove = glove_row(gloves_, glove_.kind);
  if (!glove) return wrong(glove.error());
  glove_row_ = *glove;
  glove_.kind = glove->name;
  return look_up_camera();
}

Expected<void> GraspPlay::look_up_camera() {
  // Where nobody looks, nothing says otherwise than the scene, and no camera need be installed.
  camera_row_.synthetic = true;
  if (in(options_.without, "recognition")) return {};
  const auto cameras = ask_camera_rows();
  if (!cameras) return broken(cameras.error());
  if (camera_.kind.empty()) camera_.kind = cameras->front().name;
  const auto camera = find_row(*cameras, camera_.kind, "--camera");
  if (!camera) return wrong(camera.error());
  camera_row_ = *camera;
  return {};
}

std::string GraspPlay::arm_setting() const {
  return options_.arm.find('/') == std::string::npos ? options_.arm : absolute(options_.arm);
}

void GraspPlay::choose() {
  if (!options_.hand.empty()) {
    const std::string hand = hand_setting(options_.hand);
    stage_.set("mapping.hand=" + hand);
    stage_.set("simulation.hand=" + hand);
    stage_.set("mapping.model=");  // that of the hand
  }
  if (!options_.arm.empty()) stage_.set("robot.arm=" + arm_setting());
  if (options_.direct) stage_.set("mapping.intelligent=false");
  stage_.set("recognition.source=" + camera_.kind);
  if (!camera_.detail.empty()) stage_.set("recognition.path=" + absolute(camera_.detail));
  stage_.set("glove.device=" + glove_.kind);
  if (plays_recording()) stage_.set("glove.file=" + absolute(glove_.detail));
  // The console sends there, too.
  if (glove_row_.line == "udp" && !glove_.detail.empty()) stage_.set("glove.port=" + glove_.detail);
}

// --- the lab

Expected<void> GraspPlay::listen(const service::Config& config,
                                 const std::optional<model::Scene>& truth) {
  observer_ = Observer(truth);
  const auto arm = stage::carrying_arm(config);
  if (!arm) return wrong(arm.error());
  if (*arm) observer_.expect_arm(**arm);
  auto listener = Listener::create(config, true);
  if (!listener) return broken(listener.error());
  listener_.emplace(std::move(*listener));
  stage_.on_look([this] {
    listener_->poll(observer_);
    return observer_.progress();
  });
  return {};
}

Expected<void> GraspPlay::attach() {
  const auto config = options_.lab.load();
  if (!config) return wrong(config.error());
  std::optional<model::Scene> truth;
  if (const std::filesystem::path file = config->path("lab.scene"); !file.empty()) {
    const auto catalogue = model::Catalogue::load(config->path("lab.catalogue"));
    if (!catalogue) return broken(catalogue.error());
    auto scene = model::load_scene(file, *catalogue);
    if (!scene) return broken(scene.error());
    truth = std::move(*scene);
  }
  return listen(*config, truth);
}

Expected<void> GraspPlay::put_up() {
  if (auto known = look_up(); !known) return known;
  choose();
  const auto config = stage_.config();
  if (!config) return tl::unexpected(config.error());
  hand_ = config->text("simulation.hand");
  if (options_.keep) log::info("scene and logs are in {}", stage_.folder().string());

  // The truth: the synthetic camera renders it, the synthetic hand reaches into it.
  const auto scene = make_setting({options_.seed, options_.object, model::hand_directory(hand_),
                                   config->path("lab.catalogue")});
  if (!scene) return wrong(scene.error());
  const std::filesystem::path scene_file = stage_.folder() / "scene.toml";
  if (const auto written = write_setting(*scene, scene_file); !written)
    return broken(written.error());
  if (!plays_recording()) {
    stage_.set("glove.user=" + scene->demonstrator.user);
    stage_.set(fmt::format("glove.hand_scale={:.3f}", scene->demonstrator.hand_scale));
  } else {
    stage_.may_end("glove");
  }
  const auto truth_known = camera_row_.synthetic ? std::optional(*scene) : std::nullopt;
  if (auto heard = listen(*config, truth_known); !heard) return heard;

  const std::string truth = "lab.scene=" + scene_file.string();
  if (!options_.record.empty())
    if (auto started = start_recorder(truth); !started) return started;
  if (auto started = start_services(truth); !started) return started;
  // Nobody reaches before everyone looks.
  const auto up = stage_.until(
      "starting", [&] { return missing().empty(); },
      [&] {
        return Error{missing() + " did not come up", "demo", ""};
      });
  if (!up || in(options_.without, "glove")) return up;
  if (auto planned = await_plans(); !planned) return planned;
  return start_glove(scene_file, truth);
}

/// Nor before there are grasps for what they see, or it is known that there are none, or it takes
/// too long: then the hand goes with what was found.
Expected<void> GraspPlay::await_plans() {
  if (!options_.planned || in(options_.without, "recognition")) return {};
  stage_.begin_anew();
  std::string searched_for;
  auto planned = stage_.until(
      "planning grasps", [&] { return observer_.planned(); },
      [&] {
        searched_for = observer_.unplanned();
        return Error{"nothing is seen that grasps could be planned for", "demo",
                     "see that the camera shows an object"};
      });
  if (!planned && searched_for.empty()) return planned;
  if (!planned) log::info("{}: goes on while grasps are still searched for", searched_for);
  for (const auto& [object, reason] : observer_.without_plan())
    log::info("{}: goes on without a planned grasp: {}", object, reason);
  stage_.begin_anew();
  return {};
}

std::string GraspPlay::missing() const {
  std::string names;
  for (const std::string& name : awaited_)
    if (!is_ready(name)) names += (names.empty() ? "" : ", ") + name;
  return names;
}

bool GraspPlay::is_ready(const std::string& name) const {
  return observer_.is_up(name) && (name != "robot" || observer_.has_counted(name, "readings"));
}

Expected<void> GraspPlay::await_service(const std::string& name) {
  return stage_.until(
      "starting", [&] { return observer_.is_up(name); },
      [&] {
        return Error{"did not come up", name, ""};
      });
}

// --- those who play

/// Up before the others, so that it misses nothing.
Expected<void> GraspPlay::start_recorder(const std::string& truth) {
  return stage_
      .start("recorder", "prehend-record", {"--output", absolute(options_.record), "--quiet"},
             {truth})
      .and_then([&] { return await_service("recorder"); });
}

/// Up before the others, so that all can be watched.
Expected<void> GraspPlay::start_console(const std::string& truth) {
  if (auto shown = show_page(stage_, {truth}); !shown) return shown;
  // Whom the page's buttons for teaching speak to; nobody waits for it.
  return stage_.start_service("teacher");
}

Expected<void> GraspPlay::start_services(const std::string& truth) {
  if (options_.watch)
    if (auto started = start_console(truth); !started) return started;
  for (const std::string service : {"recognition", "planner", "mapping", "simulation"}) {
    if (in(options_.without, service) || (service == "planner" && !options_.planned)) continue;
    // A real camera sees a table that nobody described: the world is built from what it sees.
    const bool told = camera_row_.synthetic || service != "simulation";
    std::vector<std::string> own{told ? truth : std::string("lab.scene=")};
    if (service == "simulation" && !options_.robot.empty()) own.push_back(hand_is_twin);
    if (auto started = stage_.start_service(service, own); !started) return started;
    awaited_.push_back(service);
  }
  return options_.robot.empty() ? Expected<void>() : start_robot();
}

/// The robot's driver takes the commands, and the emulated robot at the end of its wire moves the
/// simulated hand, which goes by another name.
Expected<void> GraspPlay::start_robot() {
  const Source robot = source_of(options_.robot);
  if (robot.kind != "emulated" || robot.detail.empty())
    return wrong({"is not emulated:DEVICE", "--robot " + options_.robot, ""});
  const std::filesystem::path port = stage_.folder() / "robot_port";
  const std::string name = "emulated " + robot.detail;
  if (auto started = stage_.start(name, "prehend-robot-tool",
                                  {"emulate", "--device", robot.detail, "--hand", hand_, "--link",
                                   port.string(), "--twin", twin});
      !started)
    return started;
  if (auto there = await_port(port, name, stage_); !there) return there;
  // Who emulates shares the processors with everybody, and may have to wait for them.
  awaited_.push_back("robot");
  return stage_.start_service(
      "robot", {"robot.device=" + robot.detail, "robot.port=" + port.string(), "robot.home=true",
                "robot.lost_after=1", "safety.deadman=false"});
}

Expected<void> GraspPlay::start_glove(const std::filesystem::path& scene_file,
                                      const std::string& truth) {
  std::vector<std::string> sets{truth};
  if (glove_row_.emulator) {
    EmulatedGlove glove{glove_row_, scene_file, glove_.detail, "", {}};
    if (glove_row_.line == "serial") glove.port = absolute(glove_.detail);
    const auto told = emulate(glove, gloves_, stage_);
    if (!told) return tl::unexpected(told.error());
    sets.insert(sets.end(), told->begin(), told->end());
  }
  return stage_.start_service("glove", sets);
}

}  // namespace prehend::cli
