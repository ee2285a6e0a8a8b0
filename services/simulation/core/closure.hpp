#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/analysis/wrench_space.hpp"
#include "common/base/error.hpp"
#include "common/grasping/hold_test.hpp"
#include "common/grasping/world.hpp"
#include "services/simulation/core/command.hpp"

namespace prehend::simulation {

/// A hand that has closed on an object: all that the judge needs, apart from the living world.
struct Closure {
  std::uint64_t number = 0;  // counts closures
  Time time{};               // of the world
  int hand = 0;              // that has closed
  Command command;           // the last one before it
  int body = 0;
  grasping::Body object;
  Eigen::VectorXd dof;  // rad
  Pose X_BO = Pose::Identity();
  std::vector<analysis::Contact> contacts;  // of all hands
  std::unique_ptr<grasping::World> world;   // a copy, to be used up
};

struct GraspVerdict {
  analysis::Quality quality;
  double penetration = 0;  // m, deepest contact
  grasping::HoldResult hold;
  /// Which fingers keep each other from opening, and in which order they open; empty: none.
  std::string blocking;
};

/// Quality of the contacts, and whether the object is held when it is lifted. Uses up the world;
/// takes about half a second and touches nothing else, so it may run in another thread.
GraspVerdict judge(Closure& closure);

/// Finds the moment at which the hand has closed on something: for 0.3 s no joint that presses has
/// moved by more than 0.015 rad and no other by more than 0.1 rad, something presses, and at least
/// two contacts on two links carry force. One drive may press the object against fingers that stand
/// at their ends; those that touch nothing tremble with the operator's hand. Weak fingers tremble
/// also where they press, or give way: they have closed when for 1 s none moves by more than 0.1
/// rad. Of several hands one may also push the object against another with its base, which then
/// stays behind where it is told to be; its fingers need not press.
class ClosureDetector {
 public:
  /// hand: its number in the world.
  explicit ClosureDetector(double time_step, int hand = 0) : time_step_(time_step), hand_(hand) {}

  /// The body that the hand has just closed on. Once a closure: not again until a closing DoF has
  /// moved by more than 0.1 rad, or a hand that pushed touches nothing.
  std::optional<int> update(const grasping::World& world);

 private:
  /// Since when the joints stand still.
  struct Rest {
    double time = 0;                                   // s
    Eigen::VectorXd joint;                             // where they were when they came to rest
    Eigen::VectorXd command;                           // what the DoFs were told then
    Eigen::Vector3d behind = Eigen::Vector3d::Zero();  // m, how far the base was then
  };
  void forget(const grasping::World& world, const grasping::HandMotion& motion);

  double time_step_;
  int hand_;
  Rest steady_, trembling_;
  std::optional<Eigen::VectorXd> judged_;  // DoFs at the last closure
  bool pushed_ = false;                    // the base pushed then
};

}  // namespace prehend::simulation
