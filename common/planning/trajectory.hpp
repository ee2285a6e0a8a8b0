#pragma once

#include <vector>

#include "common/planning/ground.hpp"

namespace prehend::planning {

/// Shares of what each joint may do, and how fast the hand may go.
struct Pace {
  double velocity = 0.8, acceleration = 0.6;
  double hand = 1.0;  // m/s, of the origin of B
  double turn = 3.0;  // rad/s
};

/// Joints over time, from rest to rest. The velocity of each is continuous, its acceleration
/// bounded.
class Trajectory {
 public:
  Trajectory() = default;

  arm::Joints at(double t) const;  // before its begin and after its end it stands
  double duration() const { return spans_.empty() ? 0 : spans_.back().begin + spans_.back().time; }
  bool empty() const { return corners_.empty(); }

 private:
  friend Trajectory timed(const Robot& robot, const Path& path, const Pace& pace);

  /// About each corner: the path goes on a parabola, s with a constant acceleration.
  struct Span {
    double begin = 0, time = 0;  // s
    double from = 0;             // s of the path, a corner is 1 long
    double speed = 0, gain = 0;  // of s, at its begin; 1/s, 1/s²
  };
  arm::Joints on_path(double s) const;

  Path corners_;
  std::vector<Span> spans_;
};

/// As fast along a path as joints and hand may. Its corners should be close together and its bends
/// gentle: see evened() and rounded().
Trajectory timed(const Robot& robot, const Path& path, const Pace& pace);

/// The same path with corners so far apart, m, see Room::swept.
Path evened(const Ground& ground, const Path& path, double apart);

/// Bends made gentle, each over so many corners at most, as far as the ground is free.
Path rounded(const Ground& ground, const Path& path, int width);

}  // namespace prehend::planning
