#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/time.hpp"
#include "common/carrying/carrying_arm.hpp"
#include "common/grasping/catalogue_bodies.hpp"
#include "common/grasping/world.hpp"
#include "common/model/scene.hpp"
#include "services/simulation/core/closure.hpp"
#include "services/simulation/core/command.hpp"
#include "services/simulation/core/touch_sense.hpp"

namespace prehend::simulation {

struct Options {
  double rate = 500;                                    // Hz, physics steps
  Duration stale = std::chrono::milliseconds(200);      // without commands: the hand holds still
  Duration max_behind = std::chrono::milliseconds(50);  // the world catches up at most this much
  grasping::BrakeLimits brake;                          // of the arm, at a stop
  double far_away = 0.10;  // m, of the hand from an object that sightings may still move
};

/// The world behind the topics: a hand that follows commands, objects from a scene or from
/// sightings, closures found. Deterministic; asks no clock. Keeps a reference to the hand.
class Simulation {
 public:
  /// arm: carries the hand, which begins at its home; none: the hand flies.
  static Expected<std::unique_ptr<Simulation>> create(
      const model::HandModel& hand, const Options& options = {},
      std::unique_ptr<carrying::CarryingArm> arm = nullptr);

  /// Objects as the scene says. Until the hand has closed on something, one that it knocked over
  /// stands where it stood once the hand is far: whoever shows the table sees it as the scene says.
  /// Fails on what cannot be simulated.
  Expected<void> build(const model::Scene& scene, const grasping::CatalogueBodies& catalogue);

  /// An object was recognised: the first sight places it on the table, later ones move it while the
  /// hand is far. True if the bodies of the world have changed. Fails when it cannot be placed.
  Expected<bool> see(const grasping::Body& body, const Pose& X_WO);

  /// By order: an object stands there from now on, whatever is seen of it. True if the bodies of
  /// the world have changed. Fails where the hand is, or another object.
  Expected<bool> place(const grasping::Body& body, const Pose& X_WO);

  /// Follows a command from now on. The first one puts a hand without an arm there at once, unless
  /// it would touch something. Refuses commands for another model, of wrong length or not finite,
  /// and far away ones.
  Expected<void> accept(const Command& command, Time now);

  /// Stops as fast as the arm can, and stays there, with its squeeze, until the next command.
  void hold();

  /// Lets the world follow the clock: drops what it is behind by more than max_behind (live) or
  /// nothing (lockstep) and returns the time dropped. The first call sets the world's time.
  Duration follow(Time now, bool lockstep);
  /// One step, if the world has not yet reached the time given to follow().
  bool step();
  /// The hand has closed since the last call.
  std::optional<Closure> take_closure();

  Time time() const { return time_; }
  const std::optional<Command>& command() const { return command_; }
  bool is_holding_still() const { return holding_; }
  /// The base still moves, though it was told to stop.
  bool is_braking() const { return braking_; }
  const grasping::World& world() const { return *world_; }
  /// What each link of the hand feels.
  const std::vector<PadTouch>& touch() const { return touch_.pads(); }
  /// What the arm does; nothing without one.
  std::optional<carrying::ArmMotion> arm_motion() const;
  const carrying::CarryingArm* arm() const { return arm_.get(); }

 private:
  Simulation(const model::HandModel& hand, const Options& options,
             std::unique_ptr<grasping::World> world, std::unique_ptr<carrying::CarryingArm> arm);
  Expected<bool> add(const grasping::Body& body, const Pose& place);
  int find(const std::string& name) const;  // -1: there is none
  /// Nothing is where a body of this shape would stand, other than `itself`.
  Expected<void> is_free(const grasping::Body& body, const Pose& X_WO, int itself) const;
  void approach(const Command& command);
  void put_back();
  void brake();

  const model::HandModel& hand_;
  Options options_;
  std::unique_ptr<grasping::World> world_;
  std::unique_ptr<carrying::CarryingArm> arm_;
  ClosureDetector detector_;
  TouchSense touch_;
  Duration period_;
  Time time_{}, goal_{};
  std::optional<Command> command_;  // the last accepted one
  Time accepted_{};
  bool holding_ = true, braking_ = false;
  std::optional<Closure> closure_;
  std::uint64_t closures_ = 0;
  std::set<std::string> placed_;  // by order
  std::vector<std::optional<Pose>>
      stood_;      // bodies of a scene that the hand is near to: X_WO before
  Time looked_{};  // at them
};

}  // namespace prehend::simulation
