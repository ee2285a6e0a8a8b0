#include "services/mapping/files/model_places.hpp"

#include "common/base/paths.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::mapping {

ModelPlaces model_places(const std::string& hand) {
  const auto share = share_directory();
  const auto folder = model::hand_directory(hand);
  std::error_code none;
  // By whatever links they are reached.
  const auto whole = std::filesystem::weakly_canonical(folder / "hand.toml", none).parent_path();
  const auto ours = std::filesystem::weakly_canonical(share / "models" / "hands", none);
  if (whole.parent_path() != ours)
    return {folder / "hand.grasps", folder / "hand.mapping", folder / "scheme.toml"};
  const std::string name = whole.filename();
  return {share / "trained" / (name + ".grasps"), share / "trained" / (name + ".mapping"),
          share / "schemes" / (name + ".toml")};
}

}  // namespace prehend::mapping
