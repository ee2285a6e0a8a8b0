#include "options.hpp"

namespace prehend::glove {

Expected<DeviceOptions> device_options(const service::Config& config) {
  DeviceOptions options;
  const std::vector<double>& n = config.numbers("tracker.X_WT");
  if (n.size() != 7)
    return fail("needs seven numbers: x y z, then w x y z", "tracker.X_WT", "see deploy/lab.toml");
  const auto X_WT = checked_pose({n[0], n[1], n[2]}, Eigen::Quaterniond(n[3], n[4], n[5], n[6]));
  if (!X_WT) return fail(X_WT.error().what, "tracker.X_WT", "see deploy/lab.toml");
  options.X_WT = *X_WT;
  options.port = config.text("glove.port");
  options.baud = static_cast<int>(config.integer("glove.baud"));
  options.sensors = static_cast<int>(config.integer("glove.sensors"));
  options.format = config.text("glove.format");
  options.file = config.path("glove.file");
  options.rate = config.number("glove.rate");
  options.hand_scale = config.number("glove.hand_scale");
  if (!(options.hand_scale >= 0.7 && options.hand_scale <= 1.4))
    return fail("must lie in 0.7 to 1.4", "glove.hand_scale", "1 is an average adult");

  auto catalogue = model::Catalogue::load(config.path("lab.catalogue"));
  if (!catalogue) return tl::unexpected(catalogue.error());
  options.catalogue = std::move(*catalogue);
  const std::filesystem::path file = config.path("lab.scene");
  if (file.empty()) {
    options.scene.X_WH = make_pose({0, 0, 0.25});
  } else {
    auto scene = model::load_scene(file, options.catalogue);
    if (!scene) return tl::unexpected(scene.error());
    options.scene = std::move(*scene);
  }
  // The synthetic hand is the demonstrator's.
  if (config.text("glove.device") == "synthetic")
    options.hand_scale = options.scene.demonstrator.hand_scale;
  return options;
}

}  // namespace prehend::glove
