#pragma once

#include <map>
#include <string>
#include <vector>

#include "services/mapping/core/capsules.hpp"

namespace prehend::mapping {

/// Keeps a robot hand off others in the same world: its base goes no nearer than leaves 5 mm
/// between them, and past them it slides. Who is nearer already comes no nearer; fingers do as they
/// are told. Hands count as capsules. A value of what it was told last.
class OtherHands {
 public:
  explicit OtherHands(const model::HandModel& hand) : hand_(hand) {}

  /// Where another hand is, in W.
  void observe(const std::string& name, std::vector<Capsule> capsules);
  void remove(const std::string& name) { others_.erase(name); }

  /// As much of the way of the base from `before` to `goal` as there is room for. dof: of our hand
  /// on the way, m or rad.
  Pose go(const Pose& before, const Pose& goal, const Eigen::VectorXd& dof) const;

 private:
  struct Other {
    std::vector<Capsule> capsules;
    Capsule all;  // that holds them: a ball
  };
  /// From what of another hand is nearest; its length is the distance, or 0 where that overlaps.
  struct Gap {
    double distance = 0;  // m, negative where they overlap
    Eigen::Vector3d away = Eigen::Vector3d::UnitZ();
  };
  Gap gap(const std::vector<Capsule>& ours) const;
  bool is_far(const Pose& before, double way) const;

  HandCapsules hand_;
  std::map<std::string, Other> others_;
};

}  // namespace prehend::mapping
