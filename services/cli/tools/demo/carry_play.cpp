#include "services/cli/tools/demo/carry_play.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "common/convert/convert.hpp"
#include "common/dds/participant.hpp"
#include "common/dds/topics.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/hand_model.hpp"
#include "common/service/membership.hpp"
#include "services/cli/tools/demo/chosen_hand.hpp"
#include "services/cli/tools/demo/emulated_glove.hpp"
#include "services/cli/tools/demo/page.hpp"

namespace prehend::cli {
namespace {

/// Whom the gloves wait for: nobody reaches before they are there.
const std::set<std::string> awaited{"simulation", "mapping", "person"};

/// The lab of a play, and what is heard of it.
class CarryPlay {
 public:
  CarryPlay(const CarryOptions& options, stage::Stage& stage) : options_(options), stage_(stage) {}

  Expected<Carried> play() {
    if (auto ready = options_.attach ? attach() : put_up(); !ready)
      return tl::unexpected(ready.error());
    const auto over = stage_.until(
        "carrying", [&] { return judge_->is_over(); },
        [&] {
          return Error{fmt::format("the {} was not lifted and set down again", object_), "demo", "",
                       exit_no};
        });
    if (!over && over.error().exit != exit_no) return tl::unexpected(over.error());
    const Carried carried = judge_->carried();
    while (over && options_.watch && stage_.look("watching")) {
    }
    return carried;
  }

 private:
  Expected<void> put_up() {
    return choose_glove().and_then([&] { return set_up(); }).and_then([&] { return start(); });
  }

  /// Starts nothing: hears the lab of the configuration, whose scene says what is carried, and
  /// where to.
  Expected<void> attach() {
    const auto config = options_.lab.load();
    if (!config) return wrong_use(config.error().what, config.error().where, config.error().hint);
    const auto file = config->path("lab.scene");
    if (file.empty())
      return wrong_use("tells nothing that two hands could carry", "lab.scene",
                       "--set lab.scene=FILE, as `prehend scene --hands …` writes it");
    const auto catalogue = model::Catalogue::load(config->path("lab.catalogue"));
    if (!catalogue) return tl::unexpected(catalogue.error());
    const auto scene = model::load_scene(file, *catalogue);
    if (!scene) return tl::unexpected(scene.error());
    if (scene->demonstrator.hands_over != (options_.task == CarryTask::hand_over))
      return wrong_use("shows another --task", file.string());
    return listen(*config, scene->demonstrator);
  }

  Expected<void> choose_glove() {
    auto gloves = ask_glove_rows();
    if (!gloves) return tl::unexpected(gloves.error());
    gloves_ = std::move(*gloves);
    auto glove = glove_row(gloves_, options_.glove);
    if (!glove) return wrong_use(glove.error().what, glove.error().where, glove.error().hint);
    glove_ = std::move(*glove);
    if (!glove_.emulator && glove_.line != "none")
      return wrong_use("has nobody who carries an object", "--glove " + glove_.name,
                       "choose one that is emulated: `prehend glove devices`");
    return {};
  }

  /// Scene and catalogue, which all are told of.
  Expected<void> set_up() {
    const auto setting = make_carry_setting(options_.task, options_.seed, options_.hands.right);
    if (!setting) return tl::unexpected(setting.error());
    const auto catalogue_file = stage_.folder() / "catalogue.toml";
    const auto scene_file = stage_.folder() / "scene.toml";
    if (auto written = write_carry_setting(*setting, catalogue_file, scene_file); !written)
      return written;
    const model::Demonstrator& person = setting->scene.demonstrator;
    stage_.set("lab.catalogue=" + catalogue_file.string());
    stage_.set("lab.scene=" + scene_file.string());
    stage_.set("mapping.model=");  // that of the hand
    stage_.set("glove.user=" + person.user);
    stage_.set(fmt::format("glove.hand_scale={:.3f}", person.hand_scale));
    scene_file_ = scene_file.string();
    const auto config = stage_.config();
    if (!config) return tl::unexpected(config.error());
    return listen(*config, person);
  }

  Expected<void> listen(const service::Config& config, const model::Demonstrator& person) {
    object_ = person.target;
    judge_.emplace(person.carry_W);
    auto participant = dds::Participant::create(service::membership(config, "prehend", "viewer"));
    if (!participant) return tl::unexpected(participant.error());
    participant_.emplace(std::move(*participant));
    auto statuses = participant_->reader(dds::service_status);
    auto objects = participant_->reader(dds::object_state);
    auto touches = participant_->reader(dds::robot_touch);
    if (!statuses || !objects || !touches) return fail("cannot listen to the lab", "demo");
    statuses_.emplace(std::move(*statuses));
    objects_.emplace(std::move(*objects));
    touches_.emplace(std::move(*touches));
    stage_.on_look([this] {
      hear();
      return fmt::format("lifted by {:.0f} mm", 1000 * judge_->carried().lifted);
    });
    return {};
  }

  void hear() {
    for (const auto& sample : statuses_->take())
      if (!sample.info.gone && sample.data.state() != v1::STATE_STARTING &&
          awaited.contains(sample.data.name().to_string()))
        up_.insert(sample.data.service().to_string());
    for (const auto& sample : touches_->take()) {
      if (sample.info.gone) continue;
      const auto& pads = sample.data.pads();
      judge_->feel(sample.data.hand().to_string(),
                   std::any_of(pads.begin(), pads.end(),
                               [](const v1::PadTouch& pad) { return pad.touching(); }));
    }
    for (const auto& sample : objects_->take()) {
      if (sample.info.gone || sample.data.body().to_string() != object_) continue;
      if (const auto X_WO = convert::from_message(sample.data.X_WO()))
        judge_->see(*X_WO, from_ns(sample.data.stamp_ns()));
    }
  }

  Expected<void> start() {
    if (!options_.record.empty())
      if (auto started = stage_.start(
              "recorder", "prehend-record",
              {"--output", std::filesystem::absolute(options_.record).string(), "--quiet"});
          !started)
        return started;
    if (options_.watch)
      if (auto started = show_page(stage_); !started) return started;
    const std::string left = hand_setting(options_.hands.left),
                      right = hand_setting(options_.hands.right);
    auto started = stage_.start_service(
        "simulation", {fmt::format("simulation.hands=[\"left:{}\", \"right:{}\"]", left, right)});
    for (const std::string side : {"left", "right"}) {
      if (!started) return started;
      started = stage_.start(
          side + " mapping", "prehend-mapping", {},
          {"mapping.hand=" + (side == "left" ? left : right), "mapping.hand_name=" + side,
           "mapping.glove=" + side, "mapping.other_hands=[\"left\", \"right\"]"});
    }
    std::size_t services = 3;
    // A tube is known, also where a hand hides it.
    if (started && options_.task == CarryTask::hand_over) {
      ++services;
      started = stage_.start("markers", "prehend-person", {"--markers"});
    }
    if (!started) return started;
    started = stage_.until(
        "starting", [&] { return up_.size() >= services; },
        [&] {
          return Error{fmt::format("{} of {} services came up", up_.size(), services), "demo", ""};
        });
    for (const std::string side : {"left", "right"}) {
      if (!started) return started;
      started = start_glove(side);
    }
    return started;
  }

  Expected<void> start_glove(const std::string& side) {
    std::vector<std::string> sets{"glove.hand=" + side, "glove.name=" + side,
                                  "glove.device=" + glove_.name};
    if (glove_.emulator) {
      const auto told =
          emulate({glove_, scene_file_, "", side + " ", {"glove.hand=" + side}}, gloves_, stage_);
      if (!told) return tl::unexpected(told.error());
      sets.insert(sets.end(), told->begin(), told->end());
    }
    return stage_.start(side + " glove", "prehend-glove", {}, sets);
  }

  const CarryOptions& options_;
  stage::Stage& stage_;
  std::optional<CarryJudge> judge_;
  std::string object_;  // that is carried
  std::string scene_file_;
  std::vector<GloveRow> gloves_;  // that there are
  GloveRow glove_;
  std::optional<dds::Participant> participant_;
  std::optional<dds::Reader<v1::ServiceStatus>> statuses_;
  std::optional<dds::Reader<v1::ObjectState>> objects_;
  std::optional<dds::Reader<v1::HandTouch>> touches_;
  std::set<std::string> up_;  // keys of those awaited that work
};

}  // namespace

Expected<Carried> carry(const CarryOptions& options, const stage::Progress& progress) {
  // The mirror image is led by the same networks.
  if (!options.attach)
    if (auto trained = train_hand({.lab = options.lab, .hand = options.hands.right}); !trained)
      return tl::unexpected(trained.error());
  auto stage = stage::Stage::create({options.lab, options.timeout, options.keep, progress});
  if (!stage) return tl::unexpected(stage.error());
  return CarryPlay(options, *stage).play();
}

}  // namespace prehend::cli
