#include "services/cli/tools/demo/carry_setting.hpp"

#include <fmt/format.h>

#include <map>

#include "common/base/file_text.hpp"
#include "common/base/random.hpp"
#include "common/model/hand_model.hpp"
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

}  // namespace

Expected<TwoHands> read_hands(const std::vector<std::string>& entries) {
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
  return TwoHands{left, hands["right"]};
}

Expected<CarrySetting> make_carry_setting(CarryTask task, std::uint64_t seed,
                                          const std::string& right) {
  Random random(seed * 7919 + 17);
  const bool pressed = task == CarryTask::carry;
  const model::CatalogueObject object = pressed ? drawn_crate(random) : drawn_tube(random);
  auto scene =
      model::make_scene(model::Catalogue({object}), seed,
                        {.target = object.name, .graspable = {object.name}, .distractors = 0});
  if (!scene) return tl::unexpected(scene.error());
  const double height = model::half_extents(object.shape).z();
  scene->objects.front().X_WO =
      make_pose(Vector3d(-0.15 + random.uniform(-0.04, 0.04), random.uniform(-0.05, 0.05), height));
  scene->demonstrator.carry_W = aside;
  const auto hand = model::HandModel::load(model::hand_directory(right));
  if (!hand) return tl::unexpected(hand.error());
  const auto X_OG = pressed ? pressing_pose(*hand, object.shape, pressed_above * height)
                            : taking_pose(object.shape);
  if (!X_OG) return wrong_use("does not reach the crate", right);
  scene->demonstrator.X_OG = *X_OG;
  scene->demonstrator.hands_over = !pressed;
  return CarrySetting{object, std::move(*scene)};
}

Expected<void> write_carry_setting(const CarrySetting& setting,
                                   const std::filesystem::path& catalogue,
                                   const std::filesystem::path& scene) {
  return write_file(catalogue, entry_of(setting.object)).and_then([&] {
    return write_setting(setting.scene, scene);
  });
}

}  // namespace prehend::cli
