#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/analysis/contact.hpp"
#include "common/analysis/wrench_space.hpp"
#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/grasping/hold_test.hpp"
#include "common/grasping/world.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::grasping {

struct PlanOptions {
  int candidates = 200;    // that are sampled, 1 to 1'000'000
  std::uint64_t seed = 1;  // of the sampling
  /// Share of candidates in which DoFs that do not close leave the posture that they begin from.
  double off_posture = 0.7;
  /// The object stands on a table: candidates that reach through it are refused.
  bool table = false;
  int tested = 10;      // grasps with the greatest epsilon that the hold test tries
  int max_tested = 50;  // when none of these held, the next `tested` are tried, up to so many
};

/// A grasp that was found, with all that is needed to repeat and to judge it. O: the object's frame
/// when the fingers have closed, B: the hand's base.
struct PlannedGrasp {
  int candidate = 0;                        // which one it was
  std::string posture;                      // named posture that the preshape was made from
  Eigen::VectorXd preshape;                 // values of the DoFs before closing
  Pose X_OB_before;                         // where the hand stands then
  Pose X_OB;                                // where the fingers have come to rest
  Eigen::VectorXd dof, joints;              // there
  std::vector<analysis::Contact> contacts;  // those that count, at most ten
  Eigen::MatrixXd wrenches;                 // of their friction edges, a column each, see analysis
  analysis::Quality quality;
  HoldResult hold;  // lifted, shaken along six directions, turned upside down
};

struct Plan {
  std::string hand;
  Body object;
  PlanOptions options;
  /// Those that the hold test has tried: held ones first, then by epsilon, greatest first.
  std::vector<PlannedGrasp> grasps;
  int closed = 0;                      // candidates that closed on the object with force closure
  std::map<std::string, int> refused;  // the other candidates, counted by reason
  std::string reason;                  // why there is no grasp that held; empty if there is one

  bool held() const { return !grasps.empty() && grasps.front().hold.held; }
};

/// Calls its second argument with 0 .. count-1, in any order, perhaps in several threads at once.
using ForEach = std::function<void(std::size_t, const std::function<void(std::size_t)>&)>;

/// Samples candidates, closes the hand on the free object in each, sorts them by epsilon and tries
/// the best by the long hold test (after GraspIt!'s planner: Miller et al., ICRA 2003). The object
/// stands upright: z of O is up. The same for a seed however the work is divided. No grasp is no
/// failure: the plan says why. Fails on objects and options that cannot be.
Expected<Plan> plan_grasps(const model::HandModel& hand, const Body& object,
                           const PlanOptions& options, const ForEach& for_each);

}  // namespace prehend::grasping
