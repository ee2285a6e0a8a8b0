#include "services/mapping/tools/training/training_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/base/log.hpp"
#include "services/mapping/tools/training/closing_lessons.hpp"
#include "services/mapping/tools/training/teach.hpp"

namespace prehend::mapping {
namespace {

/// Adds the pairs of a file to a set for the same hand.
Expected<void> add_taught(learning::TrainingSet& set, const std::filesystem::path& file) {
  auto more = learning::load_training_set(file.string());
  if (!more) return fail(more.error().what, file.string(), more.error().hint);
  if (more->hand != set.hand || more->dof_names != set.dof_names)
    return fail(fmt::format("is for the hand «{}», not for «{}»", more->hand, set.hand),
                file.string());
  if (auto ok = check_consistent(*more); !ok)
    return fail(ok.error().what, file.string() + ", " + ok.error().where, ok.error().hint);
  // Repeated until they are a tenth of all: few pairs of one person would be lost among the others.
  const std::size_t times = std::max<std::size_t>(1, set.pairs.size() / more->pairs.size() / 10);
  for (std::size_t i = 0; i < times; ++i)
    set.pairs.insert(set.pairs.end(), more->pairs.begin(), more->pairs.end());
  return {};
}

/// What to learn from, what ends the training, and other people to judge the model by.
Expected<Sets> make_sets(const TrainingRun& run, const model::HandModel& hand, const Scheme& scheme,
                         const std::vector<RobotGrasp>& grasps) {
  Sets sets;
  SetOptions others = run.people;
  others.users = 3;
  others.grasps = static_cast<int>(grasps.size());
  sets.training = demonstrate(hand, scheme, grasps, run.people);
  others.seed = run.people.seed + 1;
  sets.validation = demonstrate(hand, scheme, grasps, others);
  others.seed = run.people.seed + 2;
  others.users = 30;
  sets.test = demonstrate(hand, scheme, grasps, others);
  for (const std::filesystem::path& file : run.taught)
    if (auto added = add_taught(sets.training, file); !added) return tl::unexpected(added.error());
  if (!run.set_file.empty())
    if (auto saved = learning::save(run.set_file.string(), sets.training); !saved)
      return tl::unexpected(saved.error());
  return sets;
}

/// Those of the file, unless there is none or, of a user's hand, none that fits.
Expected<std::vector<RobotGrasp>> grasps_of(const TrainingRun& run, const model::HandModel& hand,
                                            const Scheme& scheme) {
  if (!run.close_again && std::filesystem::exists(run.grasps)) {
    auto loaded = load_robot_grasps(run.grasps, hand, run.closures.made_for);
    if (loaded || run.closures.made_for.empty()) return loaded;
    log::info("{}: {}; the hand is closed anew", run.grasps.string(), loaded.error().what);
  }
  return close_and_save(hand, scheme, run.catalogue, run.grasps, run.closures);
}

}  // namespace

Expected<TrainedMapping> run_training(const TrainingRun& run, const model::HandModel& hand,
                                      const Scheme& scheme, const grasping::ForEach& for_each,
                                      const Progress& progress) {
  auto grasps = grasps_of(run, hand, scheme);
  if (!grasps) return tl::unexpected(grasps.error());
  auto sets = make_sets(run, hand, scheme, *grasps);
  if (!sets) return tl::unexpected(sets.error());
  const auto catalogue = model::Catalogue::load(run.catalogue);
  if (!catalogue) return tl::unexpected(catalogue.error());

  TrainerOptions trainer = run.trainer;
  trainer.network.seed = static_cast<std::uint32_t>(run.people.seed);
  trainer.precision = precision_discriminant(*catalogue, hand.reach(), run.people);
  trainer.places = palm_offsets(*grasps);
  trainer.made_for = run.closures.made_for;
  ClosingLessonOptions closing;
  closing.complete = run.people.complete;
  closing.seed = run.people.seed;
  auto learnt = train_closing(closing, trainer.network);
  if (!learnt) return tl::unexpected(learnt.error());
  trainer.closing = std::move(*learnt);
  auto model = train_mapping(hand, scheme, *sets, trainer, for_each, progress);
  if (!model) return tl::unexpected(model.error());
  return TrainedMapping{std::move(*grasps), std::move(*sets), std::move(*model)};
}

}  // namespace prehend::mapping
