#include "common/arm/reach.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace prehend::arm {
namespace {

using Eigen::Vector3d;

constexpr int starts = 24;  // of a search, where there is no closed form

/// G at a place p_S, approaching at an angle from straight down, outwards, rolled about that.
Pose grasp(const Vector3d& p, Approach approach, double roll) {
  const double tilt = approach == Approach::above     ? 0.0
                      : approach == Approach::slanted ? std::numbers::pi / 4
                                                      : std::numbers::pi / 2;
  const double azimuth = std::atan2(p.y(), p.x());
  const Eigen::Quaterniond q = Eigen::AngleAxisd(azimuth, Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(std::numbers::pi - tilt, Vector3d::UnitY()) *
                               Eigen::AngleAxisd(roll, Vector3d::UnitZ());
  return make_pose(p, q);
}

/// Postures within the limits that are there, found fast rather than all.
class Finder {
 public:
  Finder(const model::ArmModel& arm, double table, std::vector<model::Capsule> carried)
      : arm_(arm), form_(puma_form(arm)), collision_(arm, {table, std::move(carried)}) {}

  /// Adds what it finds to `share`.
  Share find(const Pose& X_AE) const {
    Share share;
    const auto judge = [&](const Joints& posture) {
      const Joints q = turned_into_limits(arm_, posture);
      if (!is_within_limits(arm_, q)) return;
      share.limits = 1;
      if (collision_.clearance(forward(arm_, q), 0.01) > 0) share.free = 1;
    };
    if ((X_AE.translation() - arm_.X_AS.translation()).norm() > reach_bound(arm_)) return share;
    if (form_) {
      for (const Joints& q : solve_puma(arm_, *form_, X_AE, arm_.home)) judge(q);
      return share;
    }
    for (int k = 0; k < starts && share.free == 0; ++k)
      if (const auto q = refine(arm_, X_AE, start_within_limits(arm_, k))) judge(*q);
    return share;
  }

 private:
  const model::ArmModel& arm_;
  std::optional<PumaForm> form_;
  Collision collision_;
};

}  // namespace

double ReachRow::least() const {
  return std::min({shares[0].free, shares[1].free, shares[2].free});
}

ReachRow reach_at(const model::ArmModel& arm, const ReachTask& task, double height) {
  ReachRow row{height, {}};
  const double table = arm.X_AS.translation().z() - height;  // in A
  const Finder finder(arm, table, task.carried);
  const Pose X_GE = task.X_EG.inverse();
  for (std::size_t kind = 0; kind < approaches.size(); ++kind) {
    Share& sum = row.shares[kind];
    for (int k = 0; k < task.places; ++k) {
      const Vector3d share = evenly_spread(k);
      const Vector3d p(task.nearest + share.x() * (task.farthest - task.nearest),
                       (2 * share.y() - 1) * task.aside,
                       task.lowest + share.z() * (task.highest - task.lowest));
      Share found;
      for (int roll = 0; roll < task.rolls && found.free == 0; ++roll) {
        Pose X_AG = grasp(p, approaches[kind], 2 * std::numbers::pi * roll / task.rolls);
        X_AG.translation() +=
            Vector3d(arm.X_AS.translation().x(), arm.X_AS.translation().y(), table);
        const Share once = finder.find(X_AG * X_GE);
        found.limits = std::max(found.limits, once.limits);
        found.free = std::max(found.free, once.free);
      }
      sum.limits += found.limits;
      sum.free += found.free;
    }
    sum.limits /= task.places;  // at last: a share is never above 1
    sum.free /= task.places;
  }
  return row;
}

const ReachRow& best(const std::vector<ReachRow>& rows) {
  const auto sum = [](const ReachRow& row) {
    return row.shares[0].free + row.shares[1].free + row.shares[2].free;
  };
  return *std::max_element(rows.begin(), rows.end(), [&](const ReachRow& a, const ReachRow& b) {
    return std::pair(a.least(), sum(a)) < std::pair(b.least(), sum(b));
  });
}

}  // namespace prehend::arm
