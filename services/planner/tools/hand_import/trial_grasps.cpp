#include "services/planner/tools/hand_import/trial_grasps.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <optional>
#include <vector>

#include "common/base/workers.hpp"
#include "common/grasping/closing.hpp"
#include "common/grasping/table_test.hpp"
#include "common/model/placement.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;

constexpr double beside = 0.008;  // m, from where it shall hold as well
constexpr double nearer = 0.015;  // m, where else along the approach the hand is tried

std::vector<grasping::Body> bodies() {
  const auto cylinder = [](double radius, double height) {
    return model::Shape{model::ShapeKind::cylinder, {radius, radius, height}};
  };
  const auto box = [](double depth, double length, double height) {
    return model::Shape{model::ShapeKind::box, {depth, length, height}};
  };
  std::vector<grasping::Body> made;
  for (const model::Shape& shape :
       {cylinder(0.016, 0.14), cylinder(0.03, 0.1), cylinder(0.035, 0.22), box(0.036, 0.12, 0.1),
        box(0.042, 0.2, 0.12), box(0.064, 0.16, 0.1)})
    made.push_back({"trial", shape, 0.2, "plastic", {}, {}});
  return made;
}

/// Where a person takes it, in O.
std::optional<Pose> place(const model::Shape& shape, const model::Reach& reach) {
  const bool stands = shape.kind == model::ShapeKind::box;
  const Eigen::Matrix3d R = stands ? model::grasp_axes(-Vector3d::UnitZ(), Vector3d::UnitX())
                                   : model::grasp_axes(-Vector3d::UnitX(), Vector3d::UnitY());
  return model::nearest_grasp(shape, make_pose(Vector3d::Zero(), R), reach);
}

/// The share of two places, to either side, from which it is held.
double held(const model::HandModel& hand, const grasping::Body& body, const Pose& X_OG) {
  const Eigen::VectorXd& open = hand.postures().at("open");
  grasping::ClosingOptions options;
  options.volume = false;
  options.fixed_object = true;  // of fingers that move as one, too: the frame shall be amid them
  options.longest = 2;
  const auto closed = grasping::close_hand(hand, body, hand.X_BG() * X_OG.inverse(), open, options);
  if (!closed) return 0;
  Eigen::VectorXd closing(open.size());
  for (Eigen::Index i = 0; i < closing.size(); ++i)
    closing[i] = hand.dofs()[static_cast<std::size_t>(i)].closing;
  double count = 0;
  for (const double y : {-beside, beside})
    count += grasping::held_on_table(
                 hand, body,
                 {X_OG * Eigen::Translation3d(0, y, 0), open, hand.clamp(closed->dof), closing},
                 {.hold = 0.5, .shake = true})
                 ? 1
                 : 0;
  return count / 2;
}

}  // namespace

double trial_grasps(const model::HandModel& hand, double needed) {
  const auto tried = bodies();
  std::vector<double> counts(tried.size(), 0.0);
  const double spare = static_cast<double>(tried.size()) - needed;
  std::atomic<double> lost = 0;
  share_work(
      tried.size(), 0,
      [&](std::size_t i) {
        const auto X_OG = place(tried[i].shape, hand.reach());
        for (const double z : {0.0, -nearer, nearer})
          if (X_OG && counts[i] < 0.5 && lost <= spare)
            counts[i] =
                std::max(counts[i], held(hand, tried[i], *X_OG * Eigen::Translation3d(0, 0, z)));
        lost += 1 - counts[i];
      },
      [](std::size_t) {});
  return std::accumulate(counts.begin(), counts.end(), 0.0);
}

}  // namespace prehend::planner
