#pragma once

#include <string>

#include "common/base/paths.hpp"
#include "common/model/catalogue.hpp"
#include "common/model/placement.hpp"
#include "services/performer/core/rehearsal/rehearsal.hpp"

namespace prehend::performer {

inline const model::HandModel& barrett() {
  static const model::HandModel hand =
      model::HandModel::load(model::hand_directory("barrett")).value();
  return hand;
}

inline const model::Catalogue& objects() {
  static const model::Catalogue catalogue =
      model::Catalogue::load(share_directory() / "models/objects/catalogue.toml").value();
  return catalogue;
}

inline Thing thing(const std::string& name, double x, double y) {
  const model::CatalogueObject& known = *objects().find(name);
  return {{known.name, known.shape, known.mass, known.material, {}, {}},
          make_pose({x, y, model::half_extents(known.shape).z()})};
}

inline HandGoal resting() {
  return {make_pose({0, -0.4, 0.6}), barrett().postures().at("open")};
}

/// Taken from the side, as a person does who comes from the front.
inline Pose from_the_side() {
  return make_pose({0, 0, 0.01},
                   model::grasp_axes(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX()));
}

inline tasks::TaskModel put(const std::string& object, const std::string& reference,
                            const Eigen::Vector3d& place) {
  tasks::TaskModel task{"put", 1, {}};
  task.steps.push_back({.object = object,
                        .grasp = "medium wrap",
                        .X_OG = from_the_side(),
                        .reference = reference,
                        .X_RO = make_pose(place),
                        .via_height = 0.1,
                        .upright = true});
  return task;
}

}  // namespace prehend::performer
