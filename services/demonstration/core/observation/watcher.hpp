#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/demonstration/core/observation/seen.hpp"
#include "services/demonstration/core/observation/shown_steps.hpp"

namespace prehend::demonstration {

struct WatcherOptions {
  /// What phases look like.
  SegmenterOptions segmenter;
  /// How phases become steps.
  StepOptions steps;
  /// An object of which nothing was heard for so long is not seen any more.
  Duration stale = std::chrono::milliseconds(300);
  /// A demonstration in which the hand was away for longer is refused.
  Duration max_gap = std::chrono::milliseconds(500);
  /// A demonstration takes no longer.
  Duration max_length = std::chrono::minutes(10);
  /// A phase is told when it has been over for so long.
  Duration settled = std::chrono::milliseconds(1000);
  /// m. A hand that is so near to an object is at it.
  double near = 0.25;
};

/// A phase of a demonstration.
struct TimedSegment {
  Phase phase{};
  Time begin{}, end{};
  std::string object;  // of close, hold and release
};

/// What was understood of one demonstration.
struct Demonstration {
  std::string task;
  std::vector<TimedSegment> segments;
  tasks::ShownTask steps;
};

/// Watches a hand and the objects around it, and understands what it is shown. All times are those
/// of what is seen.
class Watcher {
 public:
  explicit Watcher(WatcherOptions options) : options_(std::move(options)) {}

  /// Fails on poses and sizes that are none, and on what is older than what was seen.
  Expected<void> see(const SeenObject& object);
  Expected<void> see(const SeenHand& hand, const std::string& kind);
  /// The object that a hand is at, if it is near one; nullptr else.
  const SeenObject* object_at(const SeenHand& hand) const;

  /// A demonstration begins. Fails while another goes on.
  Expected<void> begin(const std::string& task, Time now);
  /// The demonstration that goes on, if one does.
  const std::optional<std::string>& task() const { return task_; }
  /// Phases that are over and were not told before.
  std::vector<TimedSegment> news();
  /// It is over; says what was missing or wrong. `rest`: phases that were not told before.
  Expected<Demonstration> end(Time now, std::vector<TimedSegment>& rest);
  /// It is over and forgotten.
  void abandon();

 private:
  struct HandThen {
    double t = 0;  // s since the demonstration began
    Pose X_WG = Pose::Identity();
    double aperture = 0;
    std::string kind;
    std::vector<std::optional<Eigen::Vector3d>> p_WO;
  };
  double aperture_of(const SeenHand& hand) const;
  std::vector<std::optional<Eigen::Vector3d>> places(Time now) const;
  Expected<void> check_gaps() const;
  Seen evenly(std::size_t begin) const;
  TimedSegment timed(const Segment& segment) const;
  bool is_new(const Segment& segment) const;

  WatcherOptions options_;
  std::map<std::string, SeenObject> objects_;  // as they were seen last
  std::optional<std::string> task_;
  Time begun_{}, last_hand_{};
  double last_aperture_ = 0.08;
  std::vector<HandThen> hands_;
  std::vector<std::string> names_;  // of objects, in order of their first sight
  std::vector<Sightings> sightings_;
  double looked_ = 0;        // s, when news were looked for
  double told_ = 0;          // s, end of what was told
  double window_begin_ = 0;  // s, begin of the last rest or approach that was told
};

}  // namespace prehend::demonstration
