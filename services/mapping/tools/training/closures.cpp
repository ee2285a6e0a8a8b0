#include "services/mapping/tools/training/closures.hpp"

#include "common/base/log.hpp"
#include "common/base/progress.hpp"
#include "common/base/workers.hpp"
#include "common/model/catalogue.hpp"

namespace prehend::mapping {

Expected<std::vector<RobotGrasp>> close_and_save(const model::HandModel& hand, const Scheme& scheme,
                                                 const std::filesystem::path& catalogue_file,
                                                 const std::filesystem::path& grasps_file,
                                                 const ClosureOptions& options) {
  const auto catalogue = model::Catalogue::load(catalogue_file);
  if (!catalogue) return tl::unexpected(catalogue.error());
  const auto bodies = grasping::CatalogueBodies::create(*catalogue);
  if (!bodies) return tl::unexpected(bodies.error());
  prehend::Progress progress("closing the hand");
  auto grasps = close_on_catalogue(
      hand, scheme, *bodies,
      [&](std::size_t count, const auto& work) {
        share_work(count, 0, work, [&](std::size_t done) { progress.show(done, count); });
      },
      [&](const Error& error) {
        if (options.warns) log::warning("{}", error.message());
      },
      options.trials);
  if (grasps.empty())
    log::warning("{}: the hand can grasp nothing of it; it only imitates", catalogue_file.string());
  if (auto saved = save_robot_grasps(grasps_file, hand, grasps, options.made_for); !saved)
    return tl::unexpected(saved.error());
  return grasps;
}

}  // namespace prehend::mapping
