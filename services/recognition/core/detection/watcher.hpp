#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "services/recognition/core/detection/grasp_evidence.hpp"
#include "services/recognition/core/detection/movement.hpp"
#include "services/recognition/core/detection/tracker.hpp"

namespace prehend::recognition {

struct WatcherOptions {
  MovementOptions movement;  // what counts as moving
  TrackerOptions tracker;    // what counts as the same object
  /// Places examined in a picture at most; the others have their turn in the next ones. A picture
  /// that is new as a whole is examined wholly.
  int places = 2;
  int sweep = 15;    // every so many pictures the whole table is searched, moved or not, and
  int measure = 15;  // a steady object is measured again
  int doubts = 2;    // measurements in a row that must fail before a steady object is given up
  Duration grasp_lasts = std::chrono::milliseconds(500);  // what a hand showed counts so long
};

/// Looks at the pictures of a camera one after the other. What stands where nothing moves is known
/// already and is said again; what moved is measured or searched; the whole table is searched now
/// and then all the same. A hand that grasps what is not known raises what is doubtful and admits
/// such a grasp, where something moves. Pure: the same pictures and grasps give the same answers.
class Watcher {
 public:
  explicit Watcher(Detector detector, const WatcherOptions& options = {});

  /// The objects in a picture exposed at `stamp`. Fails when it has not the camera's size.
  Expected<std::vector<Track>> look(Time stamp, const Picture& picture, const CameraModel& camera);
  /// A hand grasps something that is not known. taxonomy: in whose order its classes are; must
  /// outlive this.
  void told(const model::GraspTaxonomy& taxonomy, SeenGrasp grasp);
  /// Numbers of the tracks that have not been seen for too long at `now`; they are forgotten.
  std::vector<std::uint32_t> expire(Time now) { return tracker_.expire(now); }

  const Movement& movement() const { return movement_; }
  /// What the last picture cost: places examined or measured.
  int fits() const { return fits_; }

 private:
  /// An object whose place is known.
  struct Known {
    Sighting seen;
    int measured = 0;  // number of the picture in which it was
    int failed = 0;    // measurements since
    Time last_seen;
    bool by_hand = false;  // a grasp raised it
  };
  /// The picture for measuring, made when first asked for.
  using Prepared = std::function<FittingImage&()>;
  void open_cells(const Plane& moved);
  std::vector<Sighting> look_at_known(Time stamp, const CameraModel& camera, const Plane& moved,
                                      const Prepared& prepared);
  void give_up(Time stamp, std::span<const Sighting> found);
  bool disturbed(const Box& box, const Plane& moved) const;
  bool hand_is_seen(Time stamp) const;
  double by_grasp(const Sighting& doubtful) const;
  std::optional<Sighting> follow_by_hand(const FittingImage& frame, const CameraModel& camera,
                                         const Sighting& before, Time stamp) const;
  void raise(std::vector<Sighting> doubtful, const Plane& moved, std::vector<Sighting>& seen) const;
  void measure(const FittingImage& frame, const CameraModel& camera, Known& known, Time stamp);

  Detector detector_;
  WatcherOptions options_;
  Movement movement_;
  Tracker tracker_;
  std::vector<Known> known_;
  const model::GraspTaxonomy* taxonomy_ = nullptr;
  std::optional<SeenGrasp> grasp_;
  Plane open_;  // cells that are to be searched
  int pictures_ = 0, fits_ = 0;
  int width_ = 0;  // px, of the last picture
};

}  // namespace prehend::recognition
