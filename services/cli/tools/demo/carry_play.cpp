#include "services/cli/tools/demo/carry_play.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "common/base/file_text.hpp"
#include "common/base/random.hpp"
#include "common/convert/convert.hpp"
#include "common/dds/participant.hpp"
#include "common/dds/topics.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/hand_model.hpp"
#include "common/service/membership.hpp"
#include "services/cli/tools/demo/chosen_hand.hpp"
#include "services/cli/tools/demo/emulated_glove.hpp"
#include "services/cli/tools/demo/page.hpp"
#include "services/cli/tools/demo/pressing.hpp"
#include "services/cli/tools/demo/setting.hpp"

namespace prehend::cli {
namespace {

using Eigen::Vector3d;

const Vector3d aside(0.30, 0, 0);  // m
/// Where a crate is pressed: so much of half its height above its middle, that it hangs level.
constexpr double pressed_above = 0.3;
/// Where a tube is taken: so much of half its height above its middle, and below it.
constexpr double taken_above = 0.5;

/// Whom the gloves wait for: nobody reaches before they are there.
const std::set<std::string> awaited{"simulation", "mapping", "person"};

/// A crate that no hand holds alone.
model::CatalogueObject drawn_crate(Random& random) {
  model::CatalogueObject object;
  object.name = "Crate";
  object.shape = {
      model::ShapeKind::box,
      Vector3d(random.uniform(0.26, 0.34), random.uniform(0.22, 0.28), random.uniform(0.22, 0.28))};
  object.mass = random.uniform(0.4, 0.8);
  object.material = "wood";
  return object;
}

/// A tube on which two hands find room, one above the other.
model::CatalogueObject drawn_tube(Random& random) {
  model::CatalogueObject object;
  object.name = "Tube";
  const double radius = random.uniform(0.028, 0.034);
  object.shape = {model::ShapeKind::cylinder, Vector3d(radius, radius, random.uniform(0.30, 0.34))};
  object.mass = random.uniform(0.1, 0.3);
  object.material = "plastic";
  return object;
}

/// Where the right hand takes a tube that stands: from its own side.
Pose taking_pose(const model::Shape& tube) {
  const Vector3d toward = -Vector3d::UnitX();
  return make_pose(Vector3d(0, 0, taken_above * model::half_extents(tube).z()),
                   model::grasp_axes(toward, toward.cross(Vector3d::UnitZ())));
}

std::string entry_of(const model::CatalogueObject& object) {
  const Vector3d& size = object.shape.size;
  return fmt::format(
      "[[object]]\nname = \"{}\"\nshape = \"{}\"\nsize = [{:.4f}, {:.4f}, {:.4f}]\nmass = {:.3f}\n"
      "material = \"{}\"\n[object.appearance]\ncolours = [[0.68, 0.51, 0.33]]\npattern = "
      "\"plain\"\nseed = 1\n",
      object.name, model::to_string(object.shape.kind), size.x(), size.y(), size.z(), object.mass,
      object.material);
}

/// The lab of a play, and what is heard of it.
class CarryPlay {
 public:
  CarryPlay(const CarryOptions& options, stage::Stage& stage)
      : options_(options), stage_(stage), judge_(aside) {}

  Expected<Carried> play() {
    if (auto chosen = choose_glove(); !chosen) return tl::unexpected(chosen.error());
    if (auto set = set_up(); !set) return tl::unexpected(set.error());
    if (auto started = start(); !started) return tl::unexpected(started.error());
    const auto over = stage_.until(
        "carrying", [&] { return judge_.is_over(); },
        [&] {
          return Error{fmt::format("the {} was not lifted and set down again", object_.name),
                       "demo", "", exit_no};
        });
    if (!over && over.error().exit != exit_no) return tl::unexpected(over.error());
    const Carried carried = judge_.carried();
    while (over && options_.watch && stage_.look("watching")) {
    }
    return carried;
  }

 private:
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
    Random random(options_.seed * 7919 + 17);
    const bool pressed = options_.task == CarryTask::carry;
    object_ = pressed ? drawn_crate(random) : drawn_tube(random);
    const auto catalogue_file = stage_.folder() / "catalogue.toml";
    const auto scene_file = stage_.folder() / "scene.toml";
    if (auto written = write_file(catalogue_file, entry_of(object_)); !written) return written;
    auto scene =
        model::make_scene(model::Catalogue({object_}), options_.seed,
                          {.target = object_.name, .graspable = {object_.name}, .distractors = 0});
    if (!scene) return tl::unexpected(scene.error());
    const double height = model::half_extents(object_.shape).z();
    scene->objects.front().X_WO = make_pose(
        Vector3d(-0.15 + random.uniform(-0.04, 0.04), random.uniform(-0.05, 0.05), height));
    scene->demonstrator.carry_W = aside;
    const auto hand = model::HandModel::load(model::hand_directory(options_.right));
    if (!hand) return tl::unexpected(hand.error());
    const auto X_OG = pressed ? pressing_pose(*hand, object_.shape, pressed_above * height)
                              : taking_pose(object_.shape);
    if (!X_OG) return wrong_use("does not reach the crate", options_.right);
    scene->demonstrator.X_OG = *X_OG;
    scene->demonstrator.hands_over = !pressed;
    if (auto written = write_setting(*scene, scene_file); !written) return written;
    stage_.set("lab.catalogue=" + catalogue_file.string());
    stage_.set("lab.scene=" + scene_file.string());
    stage_.set("mapping.model=");  // that of the hand
    stage_.set("glove.user=" + scene->demonstrator.user);
    stage_.set(fmt::format("glove.hand_scale={:.3f}", scene->demonstrator.hand_scale));
    scene_file_ = scene_file.string();
    return listen();
  }

  Expected<void> listen() {
    const auto config = stage_.config();
    if (!config) return tl::unexpected(config.error());
    auto participant = dds::Participant::create(service::membership(*config, "prehend", "viewer"));
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
      return fmt::format("lifted by {:.0f} mm", 1000 * judge_.carried().lifted);
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
      judge_.feel(sample.data.hand().to_string(),
                  std::any_of(pads.begin(), pads.end(),
                              [](const v1::PadTouch& pad) { return pad.touching(); }));
    }
    for (const auto& sample : objects_->take()) {
      if (sample.info.gone || sample.data.body().to_string() != object_.name) continue;
      if (const auto X_WO = convert::from_message(sample.data.X_WO()))
        judge_.see(*X_WO, from_ns(sample.data.stamp_ns()));
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
    const std::string left = hand_setting(options_.left), right = hand_setting(options_.right);
    auto started = stage_.start_service(
        "simulation", {fmt::format("simulation.hands=[\"left:{}\", \"right:{}\"]", left, right)});
    for (const std::string side : {"left", "right"}) {
      if (!started) return started;
      started = stage_.start(side + " mapping", "prehend-mapping", {},
                             {"mapping.hand=" + (side == "left" ? left : right),
                              "mapping.hand_name=" + side, "mapping.glove=" + side});
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
  CarryJudge judge_;
  model::CatalogueObject object_;  // that is carried
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

Expected<void> read_hands(const std::vector<std::string>& entries, CarryOptions& options) {
  const std::string some = model::hand_names().front();
  const std::string hint = fmt::format("as --hands left:{},right:{}", some, some);
  std::map<std::string, std::string> hands;
  for (const std::string& entry : entries) {
    const std::size_t colon = entry.find(':');
    const std::string side = entry.substr(0, colon);
    if (colon == std::string::npos || colon + 1 == entry.size() ||
        (side != "left" && side != "right") || hands.contains(side))
      return wrong_use("«" + entry + "» is no hand", "--hands", hint);
    hands[side] = entry.substr(colon + 1);
  }
  if (hands.size() != 2) return wrong_use("names one hand", "--hands", hint);
  std::string& left = hands["left"];
  if (!left.ends_with("_left")) left += "_left";
  for (const auto& [side, hand] : hands)
    if (!model::is_hand(model::hand_directory(hand)))
      return wrong_use("'" + hand + "' is no hand", "--hands", model::hand_hint());
  options.left = left;
  options.right = hands["right"];
  return {};
}

Expected<Carried> carry(const CarryOptions& options, const stage::Progress& progress) {
  // The mirror image is led by the same networks.
  if (auto trained = train_hand({.lab = options.lab, .hand = options.right}); !trained)
    return tl::unexpected(trained.error());
  auto stage = stage::Stage::create({options.lab, options.timeout, options.keep, progress});
  if (!stage) return tl::unexpected(stage.error());
  return CarryPlay(options, *stage).play();
}

}  // namespace prehend::cli
