#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/base/time.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/shape.hpp"
#include "services/performer/core/reproduction/arm_pilot.hpp"
#include "services/performer/core/reproduction/way.hpp"

namespace prehend::performer {

/// What a robot hand says of itself.
struct RobotNow {
  Time stamp{};
  Pose X_WB = Pose::Identity();
  Eigen::VectorXd dof, joint;
  arm::Joints arm = {};  // of the arm that carries it; empty: it flies
};

/// What it is told.
struct HandGoal {
  Pose X_WB = Pose::Identity();
  Eigen::VectorXd dof;
};

/// How a robot hand takes an object: where its base stands when the fingers close, how they are
/// before, and how they close.
struct RobotGrasp {
  Pose X_OB = Pose::Identity();
  Eigen::VectorXd preshape;
  /// Of each DoF, rad or m: on the way to all of it they go in proportion, and on past it; 0: it
  /// rests. Empty: all that close, each as fast as it may.
  Eigen::VectorXd closing = {};
  bool planned = false;  // by prehend-planner
};

enum class StepPart { approach, close, lift, carry, put_down, release, retract };
std::string_view to_string(StepPart part);
inline constexpr int part_count = 7;

/// One object is taken and put down.
struct StepOrder {
  std::string object;
  RobotGrasp grasp;
  Pose X_WO_goal = Pose::Identity();
  double via_height = 0.1;  // m, above the higher one of start and end
  double travel = 0.4;      // m above W, of the base on its way from place to place
  bool upright = false;     // on a way that is planned
};

struct PerformerOptions {
  /// m/s and rad/s. How fast the base moves and turns on long ways, on average.
  double speed = 0.3, turn_speed = 1.2;
  /// m/s. How fast it moves near the object, and while it holds it.
  double careful = 0.12;
  /// m. How far before the grasp the hand stops, to go straight in from there.
  double stand_off = 0.12;
  /// m. How high an object is lifted at least, whatever the task says.
  double min_lift = 0.08;
  /// rad/s, or what stands for it (radian_of). How fast fingers close, at most, and open.
  double finger_speed = 0.8;
  /// rad/s. A finger that is slower stands.
  double still = 0.03;
  /// s. How long the hand waits for what takes longer than it should.
  double patience = 2;
  /// m. An object that is farther from where the hand should have it is lost.
  double lost = 0.04;
  /// m. Fingers that have shifted the object so far over the table have not met around it.
  double pushed = 0.03;
  /// How often a grasp is begun again that pushed the object away or did not lift it.
  int retries = 2;
};

/// Does one step with a hand: approach, close, lift, carry, put down, release, retract; lets go and
/// begins again where a grasp did not come about. A base that moves freely travels high above all;
/// for an arm a pilot plans the long ways. Says what to
/// command at each state of the robot; time is that of the states. Keeps a reference to the hand.
class StepPerformer {
 public:
  /// from: what the hand was told last. pilot: of its arm, if it has one.
  StepPerformer(const model::HandModel& hand, StepOrder order, HandGoal from,
                const PerformerOptions& options, Pilot pilot = {});

  /// The next command. X_WO: where the object is.
  HandGoal step(const RobotNow& robot, const Pose& X_WO);

  bool over() const { return over_; }
  StepPart part() const { return part_; }
  const HandGoal& goal() const { return goal_; }
  /// What went wrong, if something did, and in which part.
  const std::optional<std::string>& failure() const { return failure_; }
  StepPart failed_part() const { return failed_part_; }
  double max_tilt() const { return max_tilt_; }  // rad, of the object in the hand

 private:
  void enter(StepPart part, const RobotNow& robot, const Pose& X_WO);
  void go(std::vector<Pose> poses, double speed, const RobotNow& robot);
  /// To `to` as the pilot says, and straight on. False: he knows no way, and that is the failure.
  bool travel(const Pose& to, std::vector<Pose> then, std::size_t straight, const RobotNow& robot,
              const Pose& X_WO);
  void approach(const RobotNow& robot, const Pose& X_WO);
  void carry(const RobotNow& robot, const Pose& X_WO);
  double high() const;  // m, of the object on its way
  void follow(const RobotNow& robot, const Pose& X_WO);
  void close(const RobotNow& robot, const Pose& X_WO);
  void open(const RobotNow& robot, const Pose& X_WO);
  void next(const RobotNow& robot, const Pose& X_WO);
  /// Lets go and begins anew, if that may be.
  bool try_again(const RobotNow& robot, const Pose& X_WO);
  /// Lets go and goes away, if the object is not in the hand any more.
  void give_up(const std::string& why, const RobotNow& robot, const Pose& X_WO);
  Eigen::VectorXd motors(const RobotNow& robot) const;
  /// How fast each DoF closes, rad/s or m/s; negative the other way, 0: it does not.
  Eigen::VectorXd closing_speeds() const;
  Pose back(const Pose& X_WB, double by) const;
  Pose raised(const Pose& X_WB) const;

  const model::HandModel& hand_;
  StepOrder order_;
  PerformerOptions options_;
  Pilot pilot_;
  HandGoal goal_;
  StepPart part_ = StepPart::approach, failed_part_ = StepPart::approach;
  bool begun_ = false, over_ = false, again_ = false;
  int tries_ = 0;
  Time since_{}, last_{}, still_since_{};
  Way way_;
  Eigen::VectorXd stood_;                // fingers, when they were last seen to move
  Pose X_WO_before_ = Pose::Identity();  // of the object
  Pose X_BO_ = Pose::Identity();         // in the hand
  Pose X_WB_gripped_ = Pose::Identity();
  std::optional<std::string> failure_;
  double max_tilt_ = 0;
};

}  // namespace prehend::performer
