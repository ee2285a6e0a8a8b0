#include "services/planner/tools/hand_import/make_hand.hpp"

#include <fmt/format.h>

#include "services/planner/tools/hand_import/anatomy.hpp"
#include "services/planner/tools/hand_import/hand_toml.hpp"
#include "services/planner/tools/hand_import/trial_grasps.hpp"

namespace prehend::planner {

Expected<MadeHand> make_hand(const Robot& robot, const std::string& name, const MeshReader& meshes,
                             const SearchEffort& effort) {
  auto findings = check(robot, meshes);
  if (!is_usable(findings)) {
    const UrdfFinding& first = findings.front();
    return fail(first.what, fmt::format("line {}: {}", first.line, first.element), first.repair);
  }
  auto mended = repair(robot, meshes);
  if (!mended) return tl::unexpected(mended.error());
  mended->robot.name = name;
  // Meshes that became primitives and shapes that were made up may overlap too.
  std::erase_if(findings, [](const UrdfFinding& f) { return f.code == "self-collision"; });
  for (UrdfFinding& finding : check(mended->robot, meshes))
    if (finding.code == "self-collision") findings.push_back(std::move(finding));
  std::string urdf = write_robot(mended->robot, "Made by `prehend hand add`.");
  const AnatomyJudge judge = [&](const Anatomy& tried, double needed) {
    const auto hand = model::HandModel::parse(urdf, write_toml(tried, name, mended->robot));
    return hand ? trial_grasps(*hand, needed) : 0;
  };
  const auto anatomy = find_anatomy(mended->robot, effort, effort.trials ? judge : AnatomyJudge());
  if (!anatomy) return tl::unexpected(anatomy.error());
  std::string toml = write_toml(*anatomy, name, mended->robot);
  auto model = model::HandModel::parse(urdf, toml);
  if (!model) return tl::unexpected(model.error());
  return MadeHand{std::move(urdf),
                  std::move(toml),
                  std::move(*model),
                  std::move(findings),
                  std::move(mended->changes),
                  anatomy->opposed};
}

}  // namespace prehend::planner
