#pragma once

#include <map>
#include <string>

#include "common/model/scene.hpp"
#include "services/recognition/core/geometry/camera_model.hpp"
#include "services/recognition/core/picture/picture.hpp"
#include "services/recognition/core/rendering/texture.hpp"

namespace prehend::recognition {

struct RenderOptions {
  int samples = 4;               // a pixel where objects are, in a row and a column each half of it
  double sensor_noise = 2.0;     // sigma, grey levels of 255
  std::uint64_t noise_seed = 1;  // another one for every picture
  double light_radius = 0.05;    // of the lamp as seen from the table; softens the shadow's edge
};

/// Draws a scene as a calibrated camera sees it: solids with painted faces on a grained table, one
/// lamp (Lambert) and light from everywhere, cast shadows, blur of the lens, noise of the sensor.
/// Colours: scene.light.gain 1 shows an albedo facing the lamp as its own sRGB colour.
class Renderer {
 public:
  explicit Renderer(const model::Catalogue& catalogue) : Renderer(catalogue.objects()) {}
  explicit Renderer(const std::vector<model::CatalogueObject>& objects);

  /// Objects of the scene that the catalogue does not know are left out.
  Picture render(const model::Scene& scene, const CameraModel& camera,
                 const RenderOptions& options = {}) const;
  /// The picture before sensor noise, and the noise by itself: a camera on a still scene needs the
  /// first only once.
  Picture render_still(const model::Scene& scene, const CameraModel& camera,
                       const RenderOptions& options = {}) const;
  static void add_noise(Picture& picture, double sigma, std::uint64_t seed);

  /// Which pixels show the object of that index in the scene.
  Plane mask(const model::Scene& scene, std::size_t object, const CameraModel& camera) const;

 private:
  struct Solid;
  std::vector<Solid> solids(const model::Scene& scene) const;

  std::map<std::string, std::pair<model::Shape, Texture>, std::less<>> known_;
};

}  // namespace prehend::recognition
