#include "services/recognition/core/detection/watcher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace prehend::recognition {
namespace {

/// Cells of a known object's region and one around it.
template <class Use>
void around(const Box& box, int cell, const Plane& cells, Use use) {
  const auto index = [&](double px) { return static_cast<int>(std::floor(px / cell)); };
  for (int y = std::max(0, index(box.y) - 1);
       y <= std::min(cells.height - 1, index(box.y + box.height) + 1); ++y)
    for (int x = std::max(0, index(box.x) - 1);
         x <= std::min(cells.width - 1, index(box.x + box.width) + 1); ++x)
      use(x, y);
}

}  // namespace

Watcher::Watcher(Detector detector, const WatcherOptions& options)
    : detector_(std::move(detector)),
      options_(options),
      movement_(options.movement),
      tracker_(options.tracker) {}

void Watcher::told(const model::GraspTaxonomy& taxonomy, SeenGrasp grasp) {
  taxonomy_ = &taxonomy;
  grasp_ = std::move(grasp);
}

bool Watcher::hand_is_seen(Time stamp) const {
  return grasp_ && stamp >= grasp_->stamp - options_.grasp_lasts &&
         stamp <= grasp_->stamp + options_.grasp_lasts;
}

double Watcher::by_grasp(const Sighting& doubtful) const {
  return raised(doubtful.probability, support(*taxonomy_, grasp_->p, doubtful.shape));
}

/// What a hand makes likely enough goes to what is seen, the likeliest first; each place is taken
/// once.
void Watcher::raise(std::vector<Sighting> doubtful, const Plane& moved,
                    std::vector<Sighting>& seen) const {
  for (Sighting& each : doubtful) each.probability = by_grasp(each);
  std::stable_sort(doubtful.begin(), doubtful.end(), [](const Sighting& a, const Sighting& b) {
    return a.probability > b.probability;
  });
  for (Sighting& each : doubtful) {
    if (each.probability < detector_.options().accept || !disturbed(each.box, moved)) continue;
    const double apart = model::half_extents(each.shape).head<2>().norm();
    const bool taken = std::any_of(seen.begin(), seen.end(), [&](const Sighting& other) {
      return std::hypot(other.at->x - each.at->x, other.at->y - each.at->y) < apart;
    });
    if (!taken) seen.push_back(std::move(each));
  }
}

bool Watcher::disturbed(const Box& box, const Plane& moved) const {
  bool any = false;
  around(box, options_.movement.cell_size, moved,
         [&](int x, int y) { any = any || moved.at(x, y); });
  return any;
}

/// What only a grasp made likely, as long as the hand is there and it stays so.
std::optional<Sighting> Watcher::follow_by_hand(const FittingImage& frame,
                                                const CameraModel& camera, const Sighting& before,
                                                Time stamp) const {
  if (!hand_is_seen(stamp)) return std::nullopt;
  auto seen = detector_.judge(frame, camera, static_cast<std::size_t>(before.class_index),
                              before.at->x, before.at->y);
  if (!seen || seen->probability < detector_.options().doubtful) return std::nullopt;
  seen->probability = by_grasp(*seen);
  if (seen->probability < detector_.options().accept) return std::nullopt;
  return seen;
}

void Watcher::measure(const FittingImage& frame, const CameraModel& camera, Known& known,
                      Time stamp) {
  ++fits_;
  known.measured = pictures_;
  auto seen = detector_.follow(frame, camera, known.seen);
  known.by_hand = known.by_hand && !seen;
  if (known.by_hand) seen = follow_by_hand(frame, camera, known.seen, stamp);
  if (seen) {
    known.seen = std::move(*seen);
    known.failed = 0;
    known.last_seen = stamp;
    return;
  }
  ++known.failed;
}

Expected<std::vector<Track>> Watcher::look(Time stamp, const Picture& picture,
                                           const CameraModel& camera) {
  if (picture.width != camera.width || picture.height != camera.height)
    return fail(fmt::format("picture has {}x{} px, the calibration {}x{}", picture.width,
                            picture.height, camera.width, camera.height),
                "camera", "calibrate for this resolution or choose the camera's");
  fits_ = 0;
  if (picture.width != width_) known_.clear();  // their regions are of another resolution
  width_ = picture.width;
  const Plane moved = movement_.look(picture);
  open_cells(moved);
  ++pictures_;

  std::optional<FittingImage> frame;
  const Prepared prepared = [&]() -> FittingImage& {
    if (!frame) frame = detector_.prepare(picture);
    return *frame;
  };
  std::vector<Sighting> seen = look_at_known(stamp, camera, moved, prepared);
  const std::size_t before = seen.size();
  std::size_t certain = before;
  if (std::any_of(open_.values.begin(), open_.values.end(), [](auto v) { return v != 0; })) {
    FittingImage& whole = prepared();
    std::fill(whole.taken.values.begin(), whole.taken.values.end(), std::uint8_t{0});
    const int most = movement_.all_new() ? std::numeric_limits<int>::max() : options_.places;
    // In a picture that is new as a whole everything moves: it does not say where a hand is.
    const bool hand = hand_is_seen(stamp) && !movement_.all_new();
    std::vector<Sighting> doubtful;
    fits_ += detector_.search(whole, camera, open_, most, seen, hand ? &doubtful : nullptr);
    certain = seen.size();
    if (hand) raise(std::move(doubtful), moved, seen);
  }
  give_up(stamp, std::span(seen).subspan(before));
  for (std::size_t i = before; i < seen.size(); ++i)
    known_.push_back({seen[i], pictures_, 0, stamp, i >= certain});

  Plane looked_at(open_.width, open_.height);
  for (std::size_t i = 0; i < open_.values.size(); ++i) looked_at.values[i] = !open_.values[i];
  movement_.learn(picture, looked_at);
  return tracker_.update(stamp, seen);
}

/// Cells where something moved are to be searched, and now and then all.
void Watcher::open_cells(const Plane& moved) {
  const bool all = movement_.all_new() || pictures_ % std::max(1, options_.sweep) == 0;
  if (all || open_.values.size() != moved.values.size())
    open_ = Plane(moved.width, moved.height, 1);
  for (std::size_t i = 0; i < moved.values.size(); ++i) open_.values[i] |= moved.values[i];
}

/// The known objects that are still to be seen, measured again where there is cause to.
std::vector<Sighting> Watcher::look_at_known(Time stamp, const CameraModel& camera,
                                             const Plane& moved, const Prepared& prepared) {
  // Nearer ones first: they hide those behind them, which are measured in what remains.
  const Eigen::Vector2d eye = camera.X_WC.translation().head<2>();
  const auto distance = [&](const Known& k) {
    return (Eigen::Vector2d(k.seen.at->x, k.seen.at->y) - eye).norm();
  };
  std::stable_sort(known_.begin(), known_.end(),
                   [&](const Known& a, const Known& b) { return distance(a) < distance(b); });
  // One steady object a picture is measured again, the one for which it is longest ago.
  const Known* due = nullptr;
  for (const Known& known : known_)
    if (pictures_ - known.measured >= options_.measure && (!due || known.measured < due->measured))
      due = &known;
  std::vector<Sighting> seen;
  for (Known& known : known_) {
    const bool stirred = disturbed(known.seen.box, moved);
    const bool again = stirred || known.failed > 0 || &known == due;
    if (again) {
      FittingImage& own = prepared();
      std::fill(own.taken.values.begin(), own.taken.values.end(), std::uint8_t{0});
      for (const Sighting& nearer : seen) nearer.region.mark(own.taken, 1);
      measure(own, camera, known, stamp);
    }
    // Where something moved, one failure is enough; where nothing did, it may be a bad measurement.
    if (known.failed > 0 && (stirred || known.failed >= options_.doubts)) continue;
    seen.push_back(known.seen);
    seen.back().fresh = again && known.failed == 0;
    known.last_seen = stamp;
  }
  return seen;
}

/// Forgets what has not been seen for as long as its track lasts, or was found elsewhere.
void Watcher::give_up(Time stamp, std::span<const Sighting> found) {
  std::erase_if(known_, [&](const Known& known) {
    if (known.failed == 0) return false;
    if (stamp - known.last_seen > options_.tracker.patience) return true;
    return std::any_of(found.begin(), found.end(),
                       [&](const Sighting& s) { return s.name == known.seen.name; });
  });
}

}  // namespace prehend::recognition
