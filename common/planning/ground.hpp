#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/planning/room.hpp"

namespace prehend::planning {

/// What is held stays upright: this direction of the hand points up, about.
struct Upright {
  Eigen::Vector3d up_B = Eigen::Vector3d::UnitZ();
  double max_tilt = 0.12;  // rad
};

/// Postures in a row, each near enough to the next to go straight.
using Path = std::vector<arm::Joints>;

/// Where an arm may go: in a room, and upright if that is asked for. Keeps references.
class Ground {
 public:
  Ground(const Robot& robot, const Room& room, const std::optional<Upright>& upright)
      : robot_(robot), room_(room), upright_(upright) {}

  bool is_free(const arm::Joints& q) const { return room_.is_free(q) && tilt(q) <= max_tilt(); }
  bool is_free(const arm::Joints& from, const arm::Joints& to) const;
  /// From one posture towards another, as straight as it may be, until something is in the way or
  /// it has come so far (m, see Room::swept). The first posture is not in the answer.
  Path walk(const arm::Joints& from, const arm::Joints& to, double longest) const;
  /// The whole way there, or nothing.
  std::optional<Path> way(const arm::Joints& from, const arm::Joints& to) const;

  double length(const arm::Joints& from, const arm::Joints& to) const {
    return room_.swept(from, to);
  }
  double length(const Path& path) const;

 private:
  double tilt(const arm::Joints& q) const;
  double max_tilt() const { return upright_ ? upright_->max_tilt : 4; }
  bool straighten(arm::Joints& q) const;

  const Robot& robot_;
  const Room& room_;
  const std::optional<Upright>& upright_;
};

struct SearchOptions {
  int max_iterations = 2000;  // of the growing trees, then there is no path
  int shortcuts = 60;         // tries to make a path shorter
  double step = 0.8;          // m, by which a tree grows at most
  std::uint64_t seed = 1;     // of where trees grow to; the same gives the same path
};

/// A path to one of the goals: straight where that is free, else by two trees that grow towards
/// each other [Kuffner2000], and then made shorter. The same each time. start and goals are free.
std::optional<Path> search(const model::ArmModel& arm, const Ground& ground,
                           const arm::Joints& start, const std::vector<arm::Joints>& goals,
                           const SearchOptions& options = {});

}  // namespace prehend::planning
