#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "common/base/time.hpp"

namespace prehend::glove {

/// What a point on a hand can do between two readings; anything beyond is an extreme point.
struct GateOptions {
  double noise = 0.015;      // m, readings differ by that much at rest (10 sigma of the tracker)
  double onset = 10;         // m/s², that a calm point may have at once
  double acceleration = 30;  // m/s², above what an arm reaches in everyday grasping
  double farthest = 0.035;   // m, that acceleration beyond the onset's may explain
  double agreement = 2.0;    // m/s: two readings that far apart confirm each other as a new place
  double memory = 0.3;       // s, after which a track says nothing about the next reading
};

/// Tells extreme points from motion: a reading must lie where the point, with its present velocity
/// and any acceleration that a hand is capable of, can be. Acceleration builds up, so what a point
/// did in the last frames says how much to allow. A reading elsewhere is withheld; when the next
/// one confirms it, or the next two lie on one path with it, the point really is there. So an
/// extreme point is never let through and a true jump costs one frame.
class PointGate {
 public:
  enum class Verdict { good, extreme, unconfirmed };

  explicit PointGate(const GateOptions& options) : options_(options) {}

  /// Times must increase.
  Verdict check(Time stamp, const Eigen::Vector3d& p);

 private:
  struct Track {
    Time stamp;
    Eigen::Vector3d p, velocity;
    double acceleration = 0;  // m/s², what the last frames needed, fading
  };
  struct Candidate {
    Time stamp;
    Eigen::Vector3d p;
  };
  void accept(Time stamp, const Eigen::Vector3d& p);
  bool confirmed(Time stamp, const Eigen::Vector3d& p) const;

  GateOptions options_;
  std::optional<Track> track_;
  std::optional<Candidate> candidate_, before_;  // withheld readings: the last, and the one before
};

}  // namespace prehend::glove
