#include "services/mapping/tools/study/parts.hpp"

#include <algorithm>
#include <filesystem>
#include <tuple>

#include "common/base/paths.hpp"
#include "services/mapping/files/mapping_model_file.hpp"
#include "services/mapping/tools/training/derived_scheme.hpp"
#include "services/mapping/tools/training/first_use.hpp"

namespace prehend::mapping {

Expected<Parts> load_parts(const std::vector<std::string>& hands, bool with_models) {
  auto catalogue =
      model::Catalogue::load(share_directory() / "models" / "objects" / "catalogue.toml");
  if (!catalogue) return tl::unexpected(catalogue.error());
  auto bodies = grasping::CatalogueBodies::create(*catalogue);
  if (!bodies) return tl::unexpected(bodies.error());
  Parts parts{std::move(*catalogue), std::move(*bodies), {}, {}};
  for (const std::string& name : hands) {
    if (parts.hands.contains(name)) continue;  // figures and benchmark name the same ones
    auto hand = model::HandModel::load(model::hand_directory(name));
    if (!hand) return tl::unexpected(hand.error());
    const auto places = ready_places(name, *hand, Needs::model_and_grasps);
    if (!places) return tl::unexpected(places.error());
    auto scheme = load_or_derive(places->scheme, *hand);
    if (!scheme) return tl::unexpected(scheme.error());
    auto grasps = load_robot_grasps(places->grasps, *hand);
    if (!grasps) return tl::unexpected(grasps.error());
    std::optional<MappingModel> model;
    if (with_models) {
      auto loaded = load_mapping_model(places->model, *hand);
      if (!loaded) return tl::unexpected(loaded.error());
      model = std::move(*loaded);
    }
    parts.hands.emplace(name, StudiedHand{std::move(*hand), std::move(*scheme), std::move(*grasps),
                                          std::move(model)});
  }
  return parts;
}

Expected<std::vector<RealTake>> load_real_takes(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<RealTake> takes;
  for (const auto& file : files)
    if (auto take = load_real_take(file)) takes.push_back(std::move(*take));
  if (takes.empty()) return fail("holds no Leap recordings of right hands", folder.string());
  return takes;
}

std::vector<const RobotGrasp*> grasps_of(const Parts& parts, const std::string& hand,
                                         model::ShapeKind shape, GraspType type) {
  std::vector<const RobotGrasp*> found;
  for (const model::CatalogueObject& object : parts.catalogue.objects()) {
    if (object.shape.kind != shape) continue;
    const RobotGrasp* best = nullptr;
    for (const RobotGrasp& grasp : parts.hand(hand).grasps)
      if (grasp.object == object.name && grasp.type == type &&
          (!best || std::tie(grasp.held, grasp.epsilon) > std::tie(best->held, best->epsilon)))
        best = &grasp;
    if (best) found.push_back(best);
  }
  return found;
}

}  // namespace prehend::mapping
