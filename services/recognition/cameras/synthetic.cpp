#include "services/recognition/cameras/sources.hpp"
#include "services/recognition/core/rendering/renderer.hpp"

namespace prehend::recognition {
namespace {

class SyntheticCamera final : public Camera {
 public:
  SyntheticCamera(Picture still, std::uint64_t seed) : still_(std::move(still)), seed_(seed) {}
  Expected<Picture> next() override {
    Picture picture = still_;
    Renderer::add_noise(picture, RenderOptions{}.sensor_noise, ++seed_);
    return picture;
  }

 private:
  Picture still_;
  std::uint64_t seed_;
};

}  // namespace

std::unique_ptr<Camera> make_synthetic(const CameraOptions& options,
                                       const model::Catalogue& catalogue,
                                       const model::Scene& scene) {
  return std::make_unique<SyntheticCamera>(Renderer(catalogue).render_still(scene, options.model),
                                           scene.texture_seed);
}

}  // namespace prehend::recognition
