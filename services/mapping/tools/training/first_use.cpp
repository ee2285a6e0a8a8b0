#include "services/mapping/tools/training/first_use.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "common/base/log.hpp"
#include "common/base/paths.hpp"
#include "common/base/workers.hpp"
#include "services/mapping/files/mapping_model_file.hpp"
#include "services/mapping/tools/training/derived_scheme.hpp"
#include "services/mapping/tools/training/training_run.hpp"

namespace prehend::mapping {
namespace {

using Clock = std::chrono::steady_clock;

bool is_there(const std::filesystem::path& file) {
  std::error_code none;
  return std::filesystem::exists(file, none);
}

/// Why the hand must be trained; empty: it need not.
std::string lack(const ModelPlaces& places, const model::HandModel& hand, Needs needs) {
  if (!is_there(places.model)) return "has no mapping model yet";
  // What comes with us is not replaced; whoever reads it says what is wrong.
  if (places.made_for.empty()) return "";
  const auto model = load_mapping_model(places.model, hand, places.made_for);
  if (!model) return fmt::format("has a mapping model that {}", model.error().what);
  if (needs == Needs::model) return "";
  if (!is_there(places.grasps)) return "has no grasps yet";
  const auto grasps = load_robot_grasps(places.grasps, hand, places.made_for);
  return grasps ? "" : fmt::format("has a file that {}", grasps.error().what);
}

Expected<TrainedMapping> train_quickly(const ModelPlaces& places, const model::HandModel& hand) {
  const auto scheme = load_or_derive(places.scheme, hand);
  if (!scheme) return tl::unexpected(scheme.error());
  TrainingRun run;
  run.catalogue = share_directory() / "models" / "objects" / "catalogue.toml";
  run.grasps = places.grasps;
  run.closures = {Trials::quick(), places.made_for, false};
  return run_training(
      run, hand, *scheme,
      [](std::size_t count, const auto& work) { share_work(count, 0, work, [](std::size_t) {}); },
      [](std::string_view, double) {});
}

}  // namespace

Expected<ModelPlaces> ready_places(const std::string& hand, const model::HandModel& model,
                                   Needs needs) {
  ModelPlaces places = model_places(hand);
  const std::string why = lack(places, model, needs);
  if (why.empty()) return places;
  log::info("the hand {} {}: it is trained now, once; that takes seconds, at most about a minute",
            model.name(), why);
  const auto begin = Clock::now();
  const auto trained = train_quickly(places, model);
  if (!trained) return tl::unexpected(trained.error());
  if (auto saved = save_mapping_model(places.model, trained->model, model); !saved)
    return tl::unexpected(saved.error());
  const auto held = std::count_if(trained->grasps.begin(), trained->grasps.end(),
                                  [](const RobotGrasp& grasp) { return grasp.held; });
  log::info(
      "made {} of {} grasps, {} of them held, in {:.0f} s; `prehend train --close` is more "
      "thorough",
      places.model.string(), trained->grasps.size(), held,
      std::chrono::duration<double>(Clock::now() - begin).count());
  return places;
}

}  // namespace prehend::mapping
