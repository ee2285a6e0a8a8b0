#include "services/planner/tools/planning/planning_task.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "common/base/printable.hpp"
#include "common/base/progress.hpp"
#include "common/base/workers.hpp"
#include "common/grasping/catalogue_bodies.hpp"
#include "common/model/catalogue.hpp"

namespace prehend::planner {

using grasping::Body;

Expected<model::HandModel> find_hand(const std::string& name) {
  const auto folder = model::hand_directory(name);
  if (name.find('/') == std::string::npos && !model::is_hand(folder))
    return fail("there is no such hand", name, model::hand_hint());
  return model::HandModel::load(folder);
}

Expected<std::vector<Body>> catalogue_bodies(const service::CatalogueArgument& catalogue,
                                             const std::vector<std::string>& names) {
  const auto file = catalogue.path();
  if (!file) return tl::unexpected(file.error());
  const auto read = model::Catalogue::load(*file);
  if (!read) return tl::unexpected(read.error());
  const auto made = grasping::CatalogueBodies::create(*read);
  if (!made) return tl::unexpected(made.error());
  std::vector<std::string> all;
  for (const model::CatalogueObject& object : read->objects()) all.push_back(object.name);
  std::vector<Body> bodies;
  for (const std::string& name : names.empty() ? all : names) {
    const Body* body = made->find(name);
    if (!body)
      return fail("there is no such object", printable(name),
                  fmt::format("{} has {}", file->string(),
                              printable(fmt::format("{}", fmt::join(all, ", ")))));
    bodies.push_back(*body);
  }
  return bodies;
}

Expected<Body> find_body(const service::CatalogueArgument& catalogue, const std::string& name) {
  return catalogue_bodies(catalogue, {name}).map([](const std::vector<Body>& bodies) {
    return bodies.front();
  });
}

Expected<grasping::Plan> plan_with_progress(const model::HandModel& hand, const Body& object,
                                            const grasping::PlanOptions& options,
                                            unsigned threads) {
  int round = 0;
  return grasping::plan_grasps(hand, object, options, [&](std::size_t count, const auto& work) {
    Progress progress(fmt::format("{} on {}: {}", hand.name(), object.name,
                                  round++ == 0 ? "closing" : "lifting"));
    share_work(count, threads, work, [&](std::size_t done) { progress.show(done, count); });
  });
}

Expected<grasping::Plan> plan_in_batches(const model::HandModel& hand, const Body& object,
                                         int candidates, unsigned threads) {
  constexpr int batch = 12, many_dofs = 12, max_factor = 4;
  const int dofs = std::max(1, static_cast<int>(hand.dofs().size()));
  grasping::PlanOptions options;
  options.tested = options.max_tested = 3;
  options.off_posture = 0.35;
  Expected<grasping::Plan> best = fail("there are no candidates", object.name);
  for (int left = candidates * std::clamp(many_dofs / dofs, 1, max_factor); left > 0;
       left -= batch, ++options.seed) {
    options.candidates = std::min(left, batch);
    auto next = plan_with_progress(hand, object, options, threads);
    const bool better = !best || (next && (next->held() || next->closed > best->closed));
    if (better) best = std::move(next);
    if (!best || best->held()) break;
  }
  return best;
}

std::string describe(const grasping::HoldResult& hold) {
  if (hold.held) return "lift, shake, turn";
  std::string survived;
  if (hold.lift.value_or(false)) survived = "lift";
  if (hold.shake.value_or(false)) survived += ", shake";
  return (survived.empty() ? "no: " : survived + "; then ") + hold.reason;
}

}  // namespace prehend::planner
