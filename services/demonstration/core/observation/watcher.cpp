#include "services/demonstration/core/observation/watcher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace prehend::demonstration {

namespace {

constexpr double look_period = 0.5;      // s
constexpr std::size_t max_objects = 64;  // at once
constexpr double max_distance = 10;      // m, of anything from the table's origin
constexpr const char* too_long = "demonstration too long";

Error missing_hand(double gap, double at) {
  return {fmt::format("the hand was not seen for {:.1f} s, {:.1f} s after the beginning", gap, at),
          {},
          "stay within the tracker's reach, and show it again"};
}

}  // namespace

Expected<void> Watcher::see(const SeenObject& object) {
  if (!is_finite(object.X_WO) || object.X_WO.translation().norm() > max_distance)
    return fail("pose of an object not usable");
  if (object.name.empty() || !model::is_valid(object.shape))
    return fail("object without name or shape");
  const auto known = objects_.find(object.name);
  if (known != objects_.end() && object.stamp <= known->second.stamp)
    return fail("object older than the last");
  if (known == objects_.end() && objects_.size() >= max_objects)
    return fail("too many objects at once");
  objects_[object.name] = object;
  if (!task_) return {};
  if (object.stamp - begun_ > options_.max_length) return fail(too_long);
  auto at = std::find(names_.begin(), names_.end(), object.name) - names_.begin();
  if (at == static_cast<std::ptrdiff_t>(names_.size())) {
    names_.push_back(object.name);
    sightings_.emplace_back();
  }
  sightings_[static_cast<std::size_t>(at)].emplace_back(to_seconds(object.stamp - begun_),
                                                        object.X_WO);
  return {};
}

double Watcher::aperture_of(const SeenHand& hand) const {
  const auto& thumb = hand.p_HF[static_cast<std::size_t>(model::Finger::thumb)];
  double sum = 0;
  int count = 0;
  // The next two fingers that are seen: the others follow them.
  for (std::size_t f = 1; thumb && f < hand.p_HF.size() && count < 2; ++f)
    if (hand.p_HF[f]) sum += (*hand.p_HF[f] - *thumb).norm(), ++count;
  return count > 0 ? sum / count : last_aperture_;
}

std::vector<std::optional<Eigen::Vector3d>> Watcher::places(Time now) const {
  std::vector<std::optional<Eigen::Vector3d>> made;
  for (const std::string& name : names_) {
    const SeenObject& object = objects_.at(name);
    if (now - object.stamp <= options_.stale)
      made.emplace_back(object.X_WO.translation());
    else
      made.emplace_back();
  }
  return made;
}

Expected<void> Watcher::see(const SeenHand& hand, const std::string& kind) {
  if (!is_finite(hand.X_WH) || hand.X_WH.translation().norm() > max_distance ||
      !(hand.scale > 0.3 && hand.scale < 3))
    return fail("pose of the hand not usable");
  if (hand.stamp <= last_hand_) return fail("posture older than the last");
  last_hand_ = hand.stamp;
  last_aperture_ = aperture_of(hand);
  if (!task_ || hand.stamp < begun_) return {};
  if (hand.stamp - begun_ > options_.max_length) return fail(too_long);
  hands_.push_back({to_seconds(hand.stamp - begun_),
                    hand.X_WH * model::HumanHand(hand.scale).X_HG(), last_aperture_, kind,
                    places(hand.stamp)});
  return {};
}

const SeenObject* Watcher::object_at(const SeenHand& hand) const {
  const Eigen::Vector3d p_WG = (hand.X_WH * model::HumanHand(hand.scale).X_HG()).translation();
  const SeenObject* best = nullptr;
  double least = options_.near;
  for (const auto& [name, object] : objects_) {
    const double distance = model::signed_distance(object.shape, object.X_WO.inverse() * p_WG);
    if (distance < least) least = distance, best = &object;
  }
  return best;
}

Expected<void> Watcher::begin(const std::string& task, Time now) {
  if (task_)
    return fail("is being shown already", *task_, "end it first: prehend demonstrate --end");
  abandon();
  task_ = task;
  begun_ = now;
  // What stands there already was seen before.
  for (const auto& [name, object] : objects_) {
    names_.push_back(name);
    sightings_.push_back({{to_seconds(object.stamp - begun_), object.X_WO}});
  }
  return {};
}

void Watcher::abandon() {
  task_.reset();
  hands_.clear();
  names_.clear();
  sightings_.clear();
  looked_ = told_ = window_begin_ = 0;
}

Expected<void> Watcher::check_gaps() const {
  const double max_gap = to_seconds(options_.max_gap);
  for (std::size_t i = 1; i < hands_.size(); ++i)
    if (const double gap = hands_[i].t - hands_[i - 1].t; gap > max_gap)
      return tl::unexpected(missing_hand(gap, hands_[i - 1].t));
  return {};
}

/// Hands at an even rate from `begin` on: between two frames that came the straight way is gone.
/// Without what was seen of objects by themselves.
Seen Watcher::evenly(std::size_t begin) const {
  std::vector<double> steps;
  for (std::size_t i = begin + 1; i < hands_.size(); ++i)
    steps.push_back(hands_[i].t - hands_[i - 1].t);
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                   steps.end());
  const double period = steps[steps.size() / 2];
  Seen made;
  std::size_t i = begin;
  for (int k = 0;; ++k) {
    const double t = hands_[begin].t + k * period;
    while (i + 1 < hands_.size() && hands_[i + 1].t <= t) ++i;
    const HandThen& before = hands_[i];
    const HandThen& after = hands_[std::min(i + 1, hands_.size() - 1)];
    const double share =
        after.t > before.t ? std::clamp((t - before.t) / (after.t - before.t), 0.0, 1.0) : 0.0;
    const Pose X_WG = interpolate(before.X_WG, after.X_WG, share);
    SceneSample sample{t, X_WG.translation(),
                       before.aperture + share * (after.aperture - before.aperture), before.p_WO};
    sample.p_WO.resize(names_.size());
    made.scene.push_back(std::move(sample));
    made.X_WG.push_back(X_WG);
    made.kinds.push_back(before.kind);
    if (i + 1 == hands_.size()) return made;
  }
}

TimedSegment Watcher::timed(const Segment& segment) const {
  return {segment.phase, begun_ + seconds(segment.begin), begun_ + seconds(segment.end),
          segment.object ? names_[*segment.object] : std::string()};
}

/// Boundaries still move a little when more is seen.
bool Watcher::is_new(const Segment& segment) const {
  return (segment.begin + segment.end) / 2 > told_;
}

std::vector<TimedSegment> Watcher::news() {
  std::vector<TimedSegment> made;
  if (!task_ || hands_.size() < 3 || hands_.back().t < looked_ + look_period) return made;
  const double now = looked_ = hands_.back().t;
  // Only from the last sure beginning on, so that a long demonstration costs no more than a short
  // one.
  const auto sure = std::lower_bound(hands_.begin(), hands_.end(), window_begin_,
                                     [](const HandThen& hand, double t) { return hand.t < t; });
  const auto begin = static_cast<std::size_t>(sure - hands_.begin());
  if (begin + 3 > hands_.size()) return made;
  const auto segments = segment(evenly(begin).scene, options_.segmenter);
  if (!segments) return made;  // it may become clear later
  for (const Segment& each : *segments) {
    if (each.end > now - to_seconds(options_.settled)) break;
    if (!is_new(each)) continue;
    made.push_back(timed(each));
    told_ = each.end;
    if (each.phase == Phase::rest || each.phase == Phase::approach) window_begin_ = each.begin;
  }
  return made;
}

Expected<Demonstration> Watcher::end(Time now, std::vector<TimedSegment>& rest) {
  if (!task_) return fail("no demonstration has begun", {}, "prehend demonstrate --name NAME");
  const auto finish = [&]() -> Expected<Demonstration> {
    if (hands_.size() < 3)
      return fail("no hand was seen", {}, "is the glove there? prehend status");
    if (auto whole = check_gaps(); !whole) return tl::unexpected(whole.error());
    if (names_.empty())
      return fail("no object was recognised", {}, "does the camera see them? prehend status");
    Seen seen = evenly(0);
    seen.objects = names_;
    seen.sightings = std::move(sightings_);
    const auto segments = segment(seen.scene, options_.segmenter);
    if (!segments) return tl::unexpected(segments.error());
    Demonstration made{.task = *task_};
    for (const Segment& each : *segments) {
      made.segments.push_back(timed(each));
      if (is_new(each)) rest.push_back(made.segments.back());
    }
    auto steps = shown_steps(seen, *segments, options_.steps);
    // A hand that has done all may go where it likes.
    const double gap = to_seconds(now - begun_) - hands_.back().t;
    if (!steps && gap > to_seconds(options_.max_gap))
      return tl::unexpected(missing_hand(gap, hands_.back().t));
    if (!steps) return tl::unexpected(steps.error());
    made.steps = std::move(*steps);
    return made;
  };
  auto made = finish();
  if (!made && made.error().where.empty()) made.error().where = *task_;
  abandon();
  return made;
}

}  // namespace prehend::demonstration
