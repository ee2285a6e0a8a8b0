#pragma once

#include <array>
#include <vector>

#include "common/arm/collision.hpp"
#include "common/arm/inverse.hpp"

namespace prehend::arm {

/// What an arm shall be able to grasp on a table before it: places in front of the shoulder, aside
/// and above the table, m.
struct ReachTask {
  double nearest = 0.25, farthest = 0.75;
  double aside = 0.35;
  double lowest = 0.05, highest = 0.25;
  Pose X_EG = Pose::Identity();  // the grasp frame of the hand that is carried
  std::vector<model::Capsule> carried;
  int places = 60;  // evenly spread, the same each time
  int rolls = 8;    // about the approach, of which one must do
};

/// How a hand comes to an object: straight down, halfway, level and away from the arm.
enum class Approach { above, slanted, level };
inline constexpr std::array approaches{Approach::above, Approach::slanted, Approach::level};

/// Shares of the places that can be reached: within the limits of the joints, and without touching
/// the table or itself.
struct Share {
  double limits = 0, free = 0;
};

/// At one height of the shoulder above the table, m.
struct ReachRow {
  double height = 0;
  std::array<Share, 3> shares;  // of each approach
  double least() const;         // of the free ones
};

ReachRow reach_at(const model::ArmModel& arm, const ReachTask& task, double height);

/// The row whose worst approach is best; of rows as good the one with most places.
const ReachRow& best(const std::vector<ReachRow>& rows);

}  // namespace prehend::arm
