#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "common/arm/kinematics.hpp"

namespace prehend::arm {

/// Shortest distance between two capsules, m, negative where they overlap, and where it is.
struct Nearest {
  double distance = 0;
  Eigen::Vector3d p_A, p_B;  // on the lines in the middle of each
};
Nearest nearest(const model::Capsule& a, const model::Capsule& b);

/// How far from each joint anything that it moves can be, m: nothing moves by more than the sum of
/// all levers times what their joints turn. carried: at the last link, in its frame.
Joints levers(const model::ArmModel& arm, const std::vector<model::Capsule>& carried);

/// What an arm may hit: itself, and what lies below a height.
struct Surroundings {
  std::optional<double> table;          // m, height of its plane in A
  std::vector<model::Capsule> carried;  // shapes at the last link, in its frame: the hand
  bool may_touch = false;               // what is carried may come to the table, as hands do
};

/// How near parts of an arm are to each other. Links that a joint joins are not looked at, the base
/// not against the table. What is carried counts as the last link.
class Collision {
 public:
  /// Two parts and how far they are apart, m. second -1: the table.
  struct Pair {
    int first = 0, second = 0;
    double distance = 0;
    Eigen::Vector3d p_A, p_B;   // on each, in A
    Eigen::Vector3d direction;  // unit, from second to first
  };

  Collision(const model::ArmModel& arm, Surroundings surroundings);

  /// All pairs of parts nearer than `range`, m.
  std::vector<Pair> near(const Configuration& at, double range) const;
  /// Least distance of any pair, at most `range`.
  double clearance(const Configuration& at, double range) const;

 private:
  struct Part {
    int link = 0;
    model::Capsule capsule;
    bool may_touch = false;
  };

  /// Calls with both parts (second -1: the table) and what is between them, for all that are not
  /// farther away than `range` then is.
  template <class Visit>
  void visit(const Configuration& at, const double& range, const Visit& visit) const;

  std::vector<Part> parts_;
  std::vector<std::pair<int, int>> pairs_;  // of parts
  std::optional<double> table_;
};

}  // namespace prehend::arm
