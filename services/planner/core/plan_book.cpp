#include "services/planner/core/plan_book.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/grasping/planned_candidates.hpp"

namespace prehend::planner {
namespace {

constexpr double min_size = 0.001;  // m, of half an object
constexpr double upright = 0.26;    // rad, that an object may lean and still stand
constexpr std::size_t max_seen = 1000, max_planned = 200;

/// Objects that share a plan have the same.
std::string key_for(const grasping::Body& body) {
  const Eigen::Vector3d& size = body.shape.size;
  return fmt::format("{} {:.3f} {:.3f} {:.3f} {:.3f} {} {}", to_string(body.shape.kind), size.x(),
                     size.y(), size.z(), body.mass, body.material, body.mesh ? body.name : "");
}

std::string reason_of(const grasping::TableGraspSearch& search) {
  if (search.attempts() == 0) return "does not fit into the hand";
  const auto& refused = search.refused();
  const auto most =
      std::max_element(refused.begin(), refused.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == refused.end() ? "" : most->first;
}

}  // namespace

PlanBook::PlanBook(const model::HandModel& hand, const grasping::CatalogueBodies& catalogue,
                   PlanStore store, const PlanBookOptions& options)
    : hand_(hand), catalogue_(catalogue), store_(std::move(store)), options_(options) {}

grasping::Body PlanBook::body_of(const model::Detection& seen) const {
  return catalogue_.seen(seen.name, grasping::shape_to_plan(seen.shape));
}

PlanBook::Entry* PlanBook::find(const std::string& key) {
  const auto found = entries_.find(key);
  return found == entries_.end() ? nullptr : &found->second;
}

void PlanBook::forget_one() {
  for (auto entry = entries_.begin(); entry != entries_.end(); ++entry)
    if (std::none_of(key_of_.begin(), key_of_.end(),
                     [&](const auto& track) { return track.second == entry->first; })) {
      entries_.erase(entry);
      return;
    }
}

Expected<void> PlanBook::observe(const model::Detection& seen) {
  if (!is_finite(seen.X_WO)) return fail("pose of a detection not finite");
  if (!is_valid(seen.shape) || model::half_extents(seen.shape).minCoeff() < min_size)
    return fail("detection without a shape");
  // Written so that not-a-number fails.
  if (!(seen.probability >= options_.min_probability)) return fail("detection not probable");
  const auto known = seen_.find(seen.track);
  if (known != seen_.end() && seen.stamp < known->second.stamp)
    return fail("detection out of order");
  if (seen.X_WO.linear()(2, 2) < std::cos(upright)) return fail("object does not stand");
  if (known == seen_.end() && seen_.size() >= max_seen) return fail("too many objects");
  const auto planned = key_of_.find(seen.track);
  const Entry* entry = planned == key_of_.end() ? nullptr : find(planned->second);
  const bool same =
      entry && known->second.name == seen.name &&
      entry->plan.object.shape.kind == seen.shape.kind &&
      (entry->plan.object.shape.size - seen.shape.size).cwiseAbs().maxCoeff() <= options_.same_size;
  seen_[seen.track] = seen;
  if (same) return {};

  grasping::Body body = body_of(seen);
  const std::string key = key_for(body);
  if (!find(key)) {
    Entry made;
    if (auto recalled = store_.recall(body)) {
      made.plan = std::move(*recalled);
      made.version = 1;
    } else {
      auto search = grasping::TableGraspSearch::create(hand_, body, options_.search);
      if (!search) return tl::unexpected(search.error());
      made.search = std::make_shared<grasping::TableGraspSearch>(std::move(*search));
    }
    made.plan.object = std::move(body);
    if (entries_.size() >= max_planned) forget_one();
    entries_.emplace(key, std::move(made));
  }
  key_of_[seen.track] = key;
  told_.erase(seen.track);
  return {};
}

void PlanBook::remove(std::uint32_t track) {
  seen_.erase(track);
  key_of_.erase(track);
  told_.erase(track);
}

std::optional<PlanBook::Work> PlanBook::next() const {
  const Entry* least = nullptr;
  std::string key;
  for (const auto& [track, of] : key_of_) {
    const Entry& entry = entries_.at(of);
    if (entry.plan.complete || (least && least->rounds <= entry.rounds)) continue;
    least = &entry;
    key = of;
  }
  if (!least) return std::nullopt;
  return Work{std::move(key), least->search};
}

void PlanBook::searched(const Work& work, bool more) {
  Entry* entry = find(work.object);
  if (!entry) return;
  ++entry->rounds;
  auto grasps = work.search->found();
  const auto same = [](const grasping::SureGrasp& a, const grasping::SureGrasp& b) {
    return a.tried == b.tried && a.room == b.room && a.follow_through == b.follow_through &&
           a.X_OG.isApprox(b.X_OG);
  };
  Plan& plan = entry->plan;
  if (!more ||
      !std::equal(grasps.begin(), grasps.end(), plan.grasps.begin(), plan.grasps.end(), same))
    ++entry->version;
  plan.grasps = std::move(grasps);
  plan.complete = !more;
  if (more) return;
  plan.reason = plan.grasps.empty() ? reason_of(*work.search) : "";
  entry->search.reset();
  store_.keep(plan);
}

std::vector<TrackPlan> PlanBook::news() {
  std::vector<TrackPlan> all;
  for (const auto& [track, key] : key_of_) {
    const Entry& entry = entries_.at(key);
    int& told = told_[track];
    if (told == entry.version) continue;
    told = entry.version;
    all.push_back({seen_.at(track), entry.plan});
  }
  return all;
}

}  // namespace prehend::planner
