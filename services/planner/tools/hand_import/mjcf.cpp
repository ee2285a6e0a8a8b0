#include "services/planner/tools/hand_import/mjcf.hpp"

#include <tinyxml2.h>

#include <algorithm>

#include "services/planner/tools/hand_import/mjcf_coupling.hpp"

namespace prehend::planner {
namespace {

bool are_alike(const UrdfFinding& a, const UrdfFinding& b) {
  return a.code == b.code && a.element == b.element && a.line == b.line && a.what == b.what;
}

/// What an element of several says is told once.
std::vector<UrdfFinding> once(const std::vector<UrdfFinding>& findings) {
  std::vector<UrdfFinding> kept;
  for (const UrdfFinding& finding : findings)
    if (std::none_of(kept.begin(), kept.end(),
                     [&](const UrdfFinding& other) { return are_alike(finding, other); }))
      kept.push_back(finding);
  return kept;
}

}  // namespace

bool is_mjcf(const std::string& text) {
  tinyxml2::XMLDocument document;
  document.Parse(text.data(), text.size());
  const auto* root = document.Error() ? nullptr : document.RootElement();
  return root && std::string_view(root->Name()) == "mujoco";
}

Expected<Robot> read_mjcf(const std::string& text, const IncludeReader& includes) {
  auto source = MjcfSource::create(text, includes);
  if (!source) return tl::unexpected(source.error());
  MjcfTree tree = read_bodies(*source);
  const MjcfActuation actuation = read_actuators(*source, tree);
  couple(*source, actuation, tree);
  tree.robot.findings = once(source->findings);
  return std::move(tree.robot);
}

}  // namespace prehend::planner
