#include "services/demonstration/tools/trials/trial.hpp"

#include <algorithm>

#include "common/base/random.hpp"
#include "common/model/placement.hpp"
#include "common/tasks/table.hpp"
#include "services/demonstration/core/tasks/learn_task.hpp"

namespace prehend::demonstration {

namespace {

constexpr double rate = 30;  // Hz, of the glove
constexpr int frames_a_picture = 3;
constexpr double hand_noise = 0.0015;     // m
constexpr double object_noise = 0.002;    // m
constexpr double max_place_error = 0.01;  // m, of what was understood
constexpr std::uint64_t elsewhere = 1000;

const Time beginning = Time(seconds(1'000'000));

/// Objects that the hand can take, in an order drawn from the seed.
std::vector<std::string> drawn_objects(const model::HandModel& hand,
                                       const model::Catalogue& catalogue, int count,
                                       Random& random) {
  std::vector<std::string> names;
  for (const model::CatalogueObject& object : catalogue.objects())
    if (model::nearest_grasp(object.shape, Pose::Identity(), hand.reach()))
      names.push_back(object.name);
  for (std::size_t i = names.size(); i > 1; --i) std::swap(names[i - 1], names[random.index(i)]);
  names.resize(std::min(names.size(), static_cast<std::size_t>(count)));
  return names;
}

bool is_right(const tasks::TaskModel& task, const std::vector<Transfer>& transfers) {
  return task.steps.size() == transfers.size() &&
         std::equal(task.steps.begin(), task.steps.end(), transfers.begin(),
                    [](const tasks::Step& step, const Transfer& transfer) {
                      return step.object == transfer.object && step.reference == tasks::the_table &&
                             (step.X_RO.translation() - transfer.to).norm() < max_place_error;
                    });
}

}  // namespace

Expected<Demonstration> watched(const Person& person, const std::string& task, std::uint64_t seed) {
  Watcher watcher{WatcherOptions{}};
  if (auto begun = watcher.begin(task, beginning); !begun) return tl::unexpected(begun.error());
  Random random(seed);
  for (int n = 0; n / rate < person.duration(); ++n) {
    const double t = n / rate;
    const Time now = beginning + seconds(t);
    if (n % frames_a_picture == 0)
      for (const Person::ObjectThen& object : person.objects(t)) {
        if (object.hidden) continue;
        Pose X_WO = object.X_WO;
        X_WO.pretranslate(random.normal3(object_noise));
        if (auto seen = watcher.see(SeenObject{now, object.name, object.shape, X_WO}); !seen)
          return tl::unexpected(seen.error());
      }
    const Person::HandThen then = person.hand(t);
    const auto tips = person.model().fingertip_poses(model::HumanHand::posture(then.closure));
    SeenHand hand{now, then.X_WH, person.model().scale(), {}};
    hand.X_WH.pretranslate(random.normal3(hand_noise));
    for (std::size_t f = 0; f < tips.size(); ++f)
      hand.p_HF[f] = tips[f].translation() + random.normal3(hand_noise);
    if (auto seen = watcher.see(hand, ""); !seen) return tl::unexpected(seen.error());
  }
  std::vector<TimedSegment> rest;
  return watcher.end(beginning + seconds(person.duration()), rest);
}

Expected<ShownTrial> show_task(const model::HandModel& hand, const model::Catalogue& catalogue,
                               int steps, std::uint64_t seed, bool by_arm) {
  Random random(seed * 7919 + static_cast<std::uint64_t>(steps));
  tasks::TableOptions table{.objects = drawn_objects(hand, catalogue, steps, random),
                            .apart = 0.24,
                            .half_width = 0.45,
                            .half_depth = 0.32};
  if (by_arm) tasks::reachable(table);
  auto shown = tasks::drawn_table(catalogue, seed, table);
  if (!shown) return tl::unexpected(shown.error());
  shown->demonstrator.reach = hand.reach();
  std::vector<Transfer> transfers;
  for (const std::string& name : table.objects) {
    const auto place = tasks::free_place(*shown, seed + transfers.size(), table);
    if (!place) return tl::unexpected(place.error());
    table.free.push_back(*place);
    const double z = model::half_extents(catalogue.find(name)->shape).z();
    transfers.push_back({name, {place->x(), place->y(), z}, 0});
  }
  const auto person = Person::create(*shown, catalogue, transfers, seed);
  if (!person) return tl::unexpected(person.error());
  const auto seen = watched(*person, "trial", seed);
  if (!seen) return tl::unexpected(seen.error());
  auto task = learn_task("trial", {seen->steps});
  if (!task) return tl::unexpected(task.error());
  auto again = tasks::drawn_table(catalogue, seed + elsewhere, table);
  if (!again) return tl::unexpected(again.error());
  const bool right = is_right(*task, transfers);
  return ShownTrial{std::move(*task), right, std::move(*again)};
}

}  // namespace prehend::demonstration
