#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <prehend/base/time.hpp>

namespace prehend::glove {

/// What a point on a hand can do between two readings; anything beyond is an extreme point.
struct GateOptions {
  double noise = 0.015;      // m, readings differ by that much at rest (10 sigma of the tracker)
  double acceleration = 30;  // m/s², above what an arm reaches in everyday grasping
  double agreement = 2.0;    // m/s: two readings that far apart confirm each other as a new place
  double memory = 0.3;       // s, after which a track says nothing about the next reading
};

/// Tells extreme points from motion: a reading must lie where the point, with its present velocity
/// and any acceleration that a hand is capable of, can be. A reading elsewhere is withheld; when
/// the next one confirms it, the point really is there. So an extreme point is never let through
/// and a true jump costs one frame.
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
  };
  struct Candidate {
    Time stamp;
    Eigen::Vector3d p;
  };
  void accept(Time stamp, const Eigen::Vector3d& p);

  GateOptions options_;
  std::optional<Track> track_;
  std::optional<Candidate> candidate_;
};

}  // namespace prehend::glove
