#include "services/glove/service/options.hpp"

#include <algorithm>
#include <fstream>

#include "common/ros2/nodes/nodes.hpp"

namespace prehend::glove {
namespace {

/// Every sensor somewhere, no two at the same place, and one on the back of the hand, which says
/// where the hand is and relative to which the fingertips are known.
Expected<std::vector<Site>> checked_sites(const std::vector<std::string>& names) {
  std::vector<Site> sites;
  for (const std::string& name : names) {
    const auto site = site_from_string(name);
    if (!site)
      return fail("there is no site '" + name + "'", "glove.sites", "choose " + site_names.list());
    if (std::find(sites.begin(), sites.end(), *site) != sites.end())
      return fail("two sensors at '" + name + "'", "glove.sites", "name each site once");
    sites.push_back(*site);
  }
  if (std::find(sites.begin(), sites.end(), Site::back_of_hand) == sites.end())
    return fail("no sensor is on the back of the hand, where the fingertips are measured from",
                "glove.sites", "put one there: a forearm's does not replace it");
  return sites;
}

Expected<std::string> read_token(const std::filesystem::path& file) {
  constexpr std::size_t min_length = 16;
  std::ifstream stream(file);
  std::string token;
  if (!std::getline(stream, token))
    return fail("cannot be read", file.string(), "glove.token_file names it");
  const auto printed = [](char c) { return c > ' ' && c <= '~'; };
  if (token.size() < min_length || !std::all_of(token.begin(), token.end(), printed))
    return fail("its first line is no token", file.string(),
                "16 letters and digits at least, as `openssl rand -hex 16` makes them");
  return token;
}

}  // namespace

Expected<DeviceOptions> device_options(const service::Config& config) {
  DeviceOptions options;
  const std::vector<double>& n = config.numbers("tracker.X_WT");
  if (n.size() != 7)
    return fail("needs seven numbers: x y z in m, then the quaternion w x y z", "tracker.X_WT",
                "see deploy/lab.toml");
  const auto X_WT = checked_pose({n[0], n[1], n[2]}, Eigen::Quaterniond(n[3], n[4], n[5], n[6]));
  if (!X_WT) return fail(X_WT.error().what, "tracker.X_WT", "see deploy/lab.toml");
  options.X_WT = *X_WT;
  options.port = config.text("glove.port");
  options.senders = config.names("glove.senders");
  options.secured = !config.text("lab.keys").empty();
  if (const auto kind = find_device(config.text("glove.device"));
      kind && kind->line == Line::nodes) {
    auto network = ros2::network_of_leaders(config.text("ros.network"), options.secured);
    if (!network) return tl::unexpected(network.error());
    options.network = std::move(*network);
  }
  if (const auto file = config.path("glove.token_file"); !file.empty()) {
    auto token = read_token(file);
    if (!token) return tl::unexpected(token.error());
    options.token = std::move(*token);
  }
  options.baud = static_cast<int>(config.integer("glove.baud"));
  auto sites = checked_sites(config.names("glove.sites"));
  if (!sites) return tl::unexpected(sites.error());
  options.sites = std::move(*sites);
  options.format = config.text("glove.format");
  options.mode = config.text("glove.mode");
  options.range = static_cast<int>(config.integer("glove.range"));
  options.hemisphere = config.text("glove.hemisphere");
  options.buttons = config.flag("glove.buttons");
  options.left = config.text("glove.hand") == "left";
  options.wrist_port = config.text("glove.wrist_port");
  options.file = config.path("glove.file");
  options.rate = config.number("glove.rate");
  options.feedback_force = config.number("glove.feedback_force");
  if (!(options.feedback_force >= 0))
    return fail("is negative", "glove.feedback_force", "N; 0: no finger is held back");
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
  // A synthetic hand is the demonstrator's.
  if (const auto kind = find_device(config.text("glove.device")); kind && kind->synthetic)
    options.hand_scale = options.scene.demonstrator.hand_scale;
  return options;
}

}  // namespace prehend::glove
