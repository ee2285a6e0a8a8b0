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
  double far_away = 0.10;  // m, of a hand from an object that sightings may still move
  /// Of several hands, how hard each is pushed on its way, so that two can hold one object; none:
  /// a hand goes where it is told, whatever it touches.
  std::optional<grasping::Push> push;
};

/// How hard several hands are pushed.
inline constexpr grasping::Push push_of_several{80, 20};  // N, N m

/// The world behind the topics: hands that follow commands, objects from a scene or from sightings,
/// closures found. Deterministic; asks no clock. Keeps references to the hands. hand: the number of
/// one; that of create() is 0.
class Simulation {
 public:
  /// arm: carries the hand, which begins at its home; none: the hand flies.
  static Expected<std::unique_ptr<Simulation>> create(
      const model::HandModel& hand, const Options& options = {},
      std::unique_ptr<carrying::CarryingArm> arm = nullptr);

  /// Adds a hand that flies, beside the others, and returns its number, 1, 2, ... Fails on what
  /// cannot be simulated.
  Expected<int> add_hand(const model::HandModel& hand);

  /// Objects as the scene says. Until a hand has closed on something, one that it knocked over
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
  /// it would touch something or come near another hand. Refuses commands for another model, of
  /// wrong length or not finite, and far away ones.
  Expected<void> accept(const Command& command, Time now, int hand = 0);

  /// Stops as fast as the arm can, and stays there, with its squeeze, until the next command.
  void hold(int hand = 0);
  /// Do both hands touch one object that nothing else touches?
  bool hold_together(int hand, int other) const;

  /// Lets the world follow the clock: drops what it is behind by more than max_behind (live) or
  /// nothing (lockstep) and returns the time dropped. The first call sets the world's time.
  Duration follow(Time now, bool lockstep);
  /// One step, if the world has not yet reached the time given to follow().
  bool step();
  /// A hand has closed since the last call; nothing: none more has.
  std::optional<Closure> take_closure();

  Time time() const { return time_; }
  const std::optional<Command>& command(int hand = 0) const { return led(hand).command; }
  bool is_holding_still(int hand = 0) const { return led(hand).holding; }
  /// The base still moves, though it was told to stop.
  bool is_braking(int hand = 0) const { return led(hand).braking; }
  const grasping::World& world() const { return *world_; }
  /// What each link of the hand feels.
  const std::vector<PadTouch>& touch(int hand = 0) const { return led(hand).touch.pads(); }
  /// What the arm does; nothing without one.
  std::optional<carrying::ArmMotion> arm_motion() const;
  const carrying::CarryingArm* arm() const { return arm_.get(); }

 private:
  /// A hand, who leads it, and what it does.
  struct Led {
    int number;
    ClosureDetector detector;
    TouchSense touch;
    std::optional<Command> command{};  // the last accepted one
    Time accepted{};
    bool holding = true, braking = false;
    std::optional<Closure> closure{};
  };

  Simulation(const Options& options, std::unique_ptr<grasping::World> world,
             std::unique_ptr<carrying::CarryingArm> arm);
  void lead(int hand);
  const Led& led(int hand) const { return hands_[static_cast<std::size_t>(hand)]; }
  Led& led(int hand) { return hands_[static_cast<std::size_t>(hand)]; }
  /// The distance of the nearest hand, m; at most that.
  double distance_to_hands(int body, double most) const;
  Expected<bool> add(const grasping::Body& body, const Pose& place);
  int find(const std::string& name) const;  // -1: there is none
  /// Is a hand near where the body would stand?
  bool hand_at(const grasping::Body& body, const Pose& X_WO) const;
  /// Nothing is where a body of this shape would stand, other than `itself`.
  Expected<void> is_free(const grasping::Body& body, const Pose& X_WO, int itself) const;
  void approach(const Command& command, int hand);
  void put_back();
  void brake(Led& led);
  void look_for_closure(Led& led);

  Options options_;
  std::unique_ptr<grasping::World> world_;
  std::unique_ptr<carrying::CarryingArm> arm_;
  std::vector<Led> hands_;
  Duration period_;
  Time time_{}, goal_{};
  std::uint64_t closures_ = 0;
  std::set<std::string> placed_;  // by order
  /// A body of the scene: where it was when no hand was near, and whether one has been since.
  struct Stood {
    std::optional<Pose> where;
    bool disturbed = false;
  };
  std::vector<Stood> stood_;
  Time looked_{};  // at them
};

}  // namespace prehend::simulation
