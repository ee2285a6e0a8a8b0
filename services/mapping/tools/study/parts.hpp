#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/hand_model.hpp"
#include "services/mapping/core/mapping_model.hpp"
#include "services/mapping/tools/judging/real_take.hpp"
#include "services/mapping/tools/training/robot_grasps.hpp"
#include "services/mapping/tools/training/scheme.hpp"

namespace prehend::mapping {

/// A hand with its scheme, how it grasps the catalogue, and its trained mapping if that is needed.
struct StudiedHand {
  model::HandModel hand;
  Scheme scheme;
  std::vector<RobotGrasp> grasps;
  std::optional<MappingModel> model;
};

/// All that experiments are made with. They only read it, from several threads.
struct Parts {
  model::Catalogue catalogue;
  grasping::CatalogueBodies bodies;  // of the catalogue
  std::map<std::string, StudiedHand> hands;
  std::vector<RealTake> real_takes;  // none where there are no recordings

  const StudiedHand& hand(const std::string& name) const { return hands.at(name); }
};

/// Loads hands, schemes, and grasps as the build has closed them; `with_models`, also the trained
/// mappings.
Expected<Parts> load_parts(const std::vector<std::string>& hands, bool with_models);

/// The right hands among the Leap recordings (CSV) of a folder, by name; what is no such recording
/// is left out. Fails where there is no folder or none in it.
Expected<std::vector<RealTake>> load_real_takes(const std::filesystem::path& folder);

/// The hand's best grasp of this type on each object of that shape that it can grasp so, in the
/// catalogue's order: held before not held, then by epsilon.
std::vector<const RobotGrasp*> grasps_of(const Parts& parts, const std::string& hand,
                                         model::ShapeKind shape, GraspType type);

}  // namespace prehend::mapping
