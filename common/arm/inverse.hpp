#pragma once

#include <optional>
#include <vector>

#include "common/arm/kinematics.hpp"
#include "common/arm/puma.hpp"

namespace prehend::arm {

/// How long postures are searched where there is no closed form.
struct SearchOptions {
  int max_starts = 320;  // spread evenly over all postures
  int patience = 96;     // starts in a row that bring nothing new
};

/// Inverse kinematics of one arm: in closed form where its build has one, else by damped least
/// squares from many starts. The same answer each time. Keeps a reference to the arm.
class Inverse {
 public:
  explicit Inverse(const model::ArmModel& arm, const SearchOptions& options = {});

  /// All branches that put E there, each joint turned into its limits where whole turns can do
  /// that. Those within the limits first. Of an arm with seven joints: those with the redundant
  /// joint at each of redundant_values(). Empty: out of reach.
  std::vector<Joints> branches(const Pose& X_AE) const;
  /// Those of an arm with seven joints whose redundant one has this value, rad.
  std::vector<Joints> branches(const Pose& X_AE, double redundant) const;

  /// Evenly over the limits of the redundant joint, rad.
  std::vector<double> redundant_values() const;
  bool has_closed_form() const { return form_.has_value(); }

 private:
  std::vector<Joints> solve(const model::ArmModel& six, const Pose& X_AE) const;

  const model::ArmModel& arm_;
  SearchOptions options_;
  std::optional<PumaForm> form_;
};

/// All branches of an arm with six joints that a search finds, in (-π, π], whatever the limits.
std::vector<Joints> search_branches(const model::ArmModel& arm, const Pose& X_AE,
                                    const SearchOptions& options = {});

/// The posture near `start` that puts E there, to 1e-9 m and rad; none where the search ends in a
/// posture that does not.
std::optional<Joints> refine(const model::ArmModel& arm, const Pose& X_AE, const Joints& start);

/// The k-th of postures that are spread evenly, always the same: within the limits, and not more
/// than half a turn from 0 where those allow that.
Joints start_within_limits(const model::ArmModel& arm, int k);

/// The k-th of places that are spread evenly over [0, 1)³.
Eigen::Vector3d evenly_spread(int k);

/// The arm without one of its joints, which stays at this value.
model::ArmModel locked(const model::ArmModel& arm, int joint, double value);

/// Sorts: those within the limits first.
void order_by_limits(const model::ArmModel& arm, std::vector<Joints>& postures);

}  // namespace prehend::arm
