#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/base/random.hpp"
#include "common/model/scene.hpp"
#include "services/recognition/core/rendering/renderer.hpp"

namespace prehend::recognition {

/// What makes a scene hard.
enum class Trial {
  open,       // the target and two other objects of the catalogue, nothing hides the target
  clutter,    // also four strangers: things that no model knows
  light,      // as open, half to one and a half times as bright, up to 20 % warmer or colder
  occluded,   // a stranger stands before the target and hides 25 to 35 % of it
  empty,      // a table without objects
  strangers,  // four strangers and nothing else
};
std::string to_string(Trial trial);

struct TrialScene {
  model::Scene scene;
  std::string target;  // empty: there is none; else the first of the scene's objects
  double hidden = 0;   // share of the target's pixels that something stands before
};

/// Draws scenes of a kind from seeds: the same seed gives the same scene.
class TrialScenes {
 public:
  /// `strangers_seed`: which things are the strangers.
  TrialScenes(const model::Catalogue& catalogue, const CameraModel& camera,
              std::uint64_t strangers_seed = 7001);

  /// None when no such scene was found in some tries.
  std::optional<TrialScene> make(Trial trial, std::uint64_t seed) const;
  const Renderer& renderer() const { return renderer_; }

 private:
  void scatter(TrialScene& made, int count, Random& random) const;
  bool occlude(TrialScene& made, Random& random) const;

  const model::Catalogue& catalogue_;
  CameraModel camera_;
  std::vector<model::CatalogueObject> strangers_;
  Renderer renderer_;
};

}  // namespace prehend::recognition
