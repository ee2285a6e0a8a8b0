#pragma once

#include <map>
#include <string>
#include <vector>

#include "services/mapping/core/capsules.hpp"

namespace prehend::mapping {

/// Keeps a robot hand off others in the same world: its base goes no nearer than leaves 5 mm
/// between them, and past them it slides. Who is nearer already comes no nearer; hands that are in
/// each other may always go away from each other's middle, and so come apart. Fingers do as they
/// are told. Hands count as capsules. A value of what it was told last.
class OtherHands {
 public:
  explicit OtherHands(const model::HandModel& hand) : hand_(hand) {}

  /// Where another hand is, in W.
  void observe(const std::string& name, std::vector<Capsule> capsules);
  void remove(const std::string& name) { others_.erase(name); }
  bool empty() const { return others_.empty(); }

  /// As much of the way of the base from `before` to `goal` as there is room for. dof: of our hand
  /// on the way, m or rad.
  Pose go(const Pose& before, const Pose& goal, const Eigen::VectorXd& dof) const;

 private:
  struct Other {
    std::vector<Capsule> capsules;
    Capsule all;  // that holds them: a ball
  };
  /// What of another hand is nearest to ours.
  struct Gap {
    double distance = 0;                              // m, negative where they overlap
    Eigen::Vector3d away = Eigen::Vector3d::UnitZ();  // unit, from there to ours
  };
  Gap gap(const std::vector<Capsule>& ours) const;
  bool is_far(const Pose& before, double way) const;
  bool leaves(const Pose& from, const Pose& to) const;

  HandCapsules hand_;
  std::map<std::string, Other> others_;
};

}  // namespace prehend::mapping
