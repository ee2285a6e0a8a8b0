#include "services/demonstration/core/observation/shown_steps.hpp"

#include <algorithm>
#include <limits>
#include <optional>

namespace prehend::demonstration {

namespace {

/// One object from the moment at which fingers closed on it to that at which they let it go.
struct Held {
  std::size_t object = 0;
  double close = 0, grasped = 0, release = 0, released = 0;  // s
};

/// Mean place of an object at rest in [begin, end] and its last orientation there.
std::optional<Pose> at_rest(const Sightings& sightings, double begin, double end) {
  std::optional<Pose> made;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (const auto& [t, X_WO] : sightings) {
    if (t < begin || t > end) continue;
    made = X_WO;
    sum += X_WO.translation();
    ++count;
  }
  if (made) made->translation() = sum / count;
  return made;
}

/// The last place before a time; the mean of what was seen shortly before that sight.
std::optional<Pose> last_before(const Sightings& sightings, double end, double average) {
  double last = -std::numeric_limits<double>::infinity();
  for (const auto& [t, X_WO] : sightings)
    if (t <= end) last = std::max(last, t);
  return at_rest(sightings, last - average, std::min(last, end));
}

std::size_t sample_at(const Seen& seen, double t) {
  std::size_t i = 0;
  while (i + 1 < seen.scene.size() && seen.scene[i].t < t) ++i;
  return i;
}

class Steps {
 public:
  Steps(const Seen& seen, const StepOptions& options) : seen_(seen), options_(options) {}

  Expected<std::vector<Held>> held(const std::vector<Segment>& segments) const {
    std::vector<Held> made;
    std::optional<Held> now;
    for (const Segment& segment : segments) {
      if (segment.phase == Phase::close)
        now = Held{.object = segment.object.value_or(0), .close = segment.begin};
      if (segment.phase == Phase::hold) {
        if (!now) now = Held{.close = segment.begin};
        if (!segment.object)
          return fail("something was taken that was never recognised", {},
                      "are its model and its light right? prehend objects detect");
        now->object = *segment.object;
        now->grasped = segment.begin;
      }
      if (segment.phase == Phase::release && now) {
        now->release = segment.begin;
        now->released = segment.end;
        made.push_back(*now);
        now.reset();
      }
    }
    // Of an object that is not seen, segmentation cannot tell that the hand has left it.
    if (now)
      return fail("is still in the hand, or out of sight", seen_.objects[now->object],
                  "put it down where the camera sees it, before the end");
    return made;
  }

  /// Nothing: the object was touched and stayed where it was.
  Expected<std::optional<tasks::ShownStep>> step(const Held& held, double until) const {
    const std::string& name = seen_.objects[held.object];
    const Sightings& sightings = seen_.sightings[held.object];
    const std::size_t begin = sample_at(seen_, held.grasped), end = sample_at(seen_, held.release);
    tasks::ShownStep made{
        .object = name, .grasp = seen_.kinds[begin], .X_WG_grasped = seen_.X_WG[begin]};
    const auto before = last_before(sightings, held.close, options_.average);
    if (!before)
      return fail("was not seen before it was taken", name, "show it to the camera first");
    made.X_WO_before = *before;
    const Pose X_GO = made.X_WG_grasped.inverse() * *before;
    const Pose carried = seen_.X_WG[end] * X_GO;
    // Of what lies there again, the last sight before it is taken the next time.
    const auto after = at_rest(sightings, held.released, until);
    if (!after)
      return fail("was not seen again after it was put down", name,
                  "leave it where the camera sees it, and end a second later");
    made.X_WO_after = *last_before(sightings, until, options_.average);
    if ((made.X_WO_after.translation() - made.X_WO_before.translation()).norm() <
            options_.min_way &&
        (carried.translation() - before->translation()).norm() < options_.min_way)
      return std::nullopt;
    made.highest = std::max(before->translation().z(), made.X_WO_after.translation().z());
    for (std::size_t i = begin; i <= end; ++i) {
      const Pose X_WO = seen_.X_WG[i] * X_GO;
      made.highest = std::max(made.highest, X_WO.translation().z());
      made.max_tilt = std::max(made.max_tilt, tasks::tilt(X_WO));
    }
    for (std::size_t other = 0; other < seen_.objects.size(); ++other)
      if (other != held.object)
        if (const auto X_WR = last_before(seen_.sightings[other], held.release, options_.average))
          made.X_WR[seen_.objects[other]] = *X_WR;
    return made;
  }

 private:
  const Seen& seen_;
  const StepOptions& options_;
};

}  // namespace

Expected<tasks::ShownTask> shown_steps(const Seen& seen, const std::vector<Segment>& segments,
                                       const StepOptions& options) {
  const Steps steps(seen, options);
  const auto held = steps.held(segments);
  if (!held) return tl::unexpected(held.error());
  tasks::ShownTask made;
  for (std::size_t i = 0; i < held->size(); ++i) {
    double until = std::numeric_limits<double>::infinity();
    for (std::size_t k = i + 1; k < held->size(); ++k)
      if ((*held)[k].object == (*held)[i].object) until = std::min(until, (*held)[k].close);
    auto step = steps.step((*held)[i], until);
    if (!step) return tl::unexpected(step.error());
    if (*step) made.push_back(std::move(**step));
  }
  if (made.empty())
    return fail("nothing was taken and put somewhere else", {},
                "take an object, carry it, put it down, and take the hand away");
  return made;
}

}  // namespace prehend::demonstration
