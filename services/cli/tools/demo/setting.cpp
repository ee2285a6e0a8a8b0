#include "services/cli/tools/demo/setting.hpp"

#include <fmt/format.h>

#include <fstream>

#include "common/model/catalogue.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/human_hand.hpp"
#include "common/model/placement.hpp"

namespace prehend::cli {
namespace {

/// The grasp frame from which the scene's person would take the object: from the side of the yaw.
std::optional<Pose> grasp_of(const model::Scene& scene, const model::CatalogueObject& object,
                             const Pose& X_WO, const model::Reach& reach) {
  const double yaw = scene.demonstrator.grasp_yaw;
  const Eigen::Vector3d approach(-std::cos(yaw), -std::sin(yaw), 0);
  const Eigen::Matrix3d R = model::grasp_axes(approach, approach.cross(Eigen::Vector3d::UnitZ()));
  const auto X_OG =
      model::nearest_grasp(object.shape, X_WO.inverse() * make_pose(X_WO.translation(), R), reach);
  if (!X_OG) return std::nullopt;
  return X_WO * *X_OG;
}

}  // namespace

Expected<model::Scene> make_setting(const SettingOptions& options) {
  const auto catalogue = model::Catalogue::load(options.catalogue);
  if (!catalogue) return tl::unexpected(catalogue.error());
  const auto hand = model::HandModel::load(options.hand);
  if (!hand) return tl::unexpected(hand.error());

  model::SceneOptions wishes;
  wishes.target = options.object;
  for (const model::CatalogueObject& object : catalogue->objects())
    if (model::nearest_grasp(object.shape, Pose::Identity(), hand->reach()))
      wishes.graspable.push_back(object.name);
  if (wishes.graspable.empty())
    return fail("the hand can hold nothing of the catalogue", options.hand.string(),
                "choose another --hand, or add a smaller object to " + options.catalogue.string());
  auto scene = model::make_scene(*catalogue, options.seed, wishes);
  if (!scene) return scene;
  scene->demonstrator.reach = hand->reach();

  for (const model::PlacedObject& placed : scene->objects) {
    if (placed.name != scene->demonstrator.target) continue;
    const model::HumanHand human(scene->demonstrator.hand_scale);
    if (const auto X_WG =
            grasp_of(*scene, *catalogue->find(placed.name), placed.X_WO, hand->reach()))
      scene->X_WH = *X_WG * human.X_HG().inverse();
  }
  return scene;
}

Expected<void> write_setting(const model::Scene& scene, const std::filesystem::path& file) {
  std::ofstream stream(file);
  stream << model::to_toml(scene);
  stream.flush();
  if (!stream)
    return fail("cannot be written", file.string(), "is there room, and is the folder writable?");
  return {};
}

}  // namespace prehend::cli
