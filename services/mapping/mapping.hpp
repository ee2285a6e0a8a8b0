#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <prehend/base/error.hpp>
#include <prehend/base/pose.hpp>
#include <prehend/base/time.hpp>
#include <prehend/model/hand_model.hpp>
#include <prehend/retargeting/retargeter.hpp>
#include <string>
#include <string_view>

#include "arbitration.hpp"
#include "arrival.hpp"
#include "features.hpp"
#include "follow_through.hpp"
#include "grasp_type.hpp"
#include "grip.hpp"
#include "mapping_model.hpp"
#include "right_of_way.hpp"

namespace prehend::mapping {

/// A hand as hand/posture says it.
struct Posture {
  Time stamp, origin;  // acquisition, and head of the chain
  Pose X_WH = Pose::Identity();
  double hand_scale = 1;
  Fingertips fingertips;
};

/// An object as object/detection says it.
struct Detection {
  std::uint32_t track = 0;
  std::string name;
  model::Shape shape;
  Pose X_WO = Pose::Identity();
  double probability = 0;
  Time stamp;
  /// Of x, y, z (m) and the turn about z (rad); zero: exact.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
};

/// How fingers are answered where no object is known; with one, its network's answer is blended in.
enum class FingerMode {
  joints,      // the trained direct network: postures to postures
  cartesian,   // fingertips to fingertips by inverse kinematics
  combined,    // joints for power grasps, fingertips for precision grasps, and smoothly between
  retargeting  // vectors to fingertips by optimisation
};

std::string_view to_string(FingerMode mode);
std::optional<FingerMode> finger_mode_from_string(std::string_view name);

enum class Mode { hold, direct, intelligent };

/// What the robot hand shall do, as robot/command says it.
struct Command {
  Time stamp;                  // of the posture; of the tick when holding
  std::optional<Time> origin;  // of the glove frame; none when holding
  Eigen::VectorXd dof;         // rad, or m of what slides
  Pose X_WB = Pose::Identity();
  Mode mode = Mode::hold;
  double weight = 0;   // of the intelligent answer
  std::string object;  // empty: none
  GraspType grasp_type = GraspType::none;
  bool extrapolating = false;
};

struct MappingOptions {
  FingerMode fingers = FingerMode::joints;
  bool intelligent = true;                      // let detections improve the fingers
  bool place = true;                            // let detections correct the placement
  double enter = 0.20, leave = 0.25;            // m, from G to the nearest grasp of an object
  double enter_angle = 0.8, leave_angle = 1.1;  // rad, the same
  double prefer = 0.03;  // m, by which another object must be nearer to take over
  double least_probability = 0.6;
  /// Standard deviations up to which a detection is as good as exact, because a grasp forgives as
  /// much: position, turn of what is not round, and size as a share of itself. Beyond, the
  /// intelligent answer counts (tolerance / deviation)² at most.
  double sure_position = 0.01, sure_turn = 0.1745, sure_size = 0.2;  // m, rad, 1
  Duration fresh = std::chrono::milliseconds(500);       // age at which a detection counts as gone
  Duration ramp = std::chrono::milliseconds(300);        // weight from 0 to 1
  Duration silence = std::chrono::milliseconds(60);      // without postures, until it holds
  Duration hold_period = std::chrono::milliseconds(10);  // between commands to hold, at least
  Duration state_wait = std::chrono::seconds(1);         // for robot/state, before starting without
  double correct_distance = 0.03;                        // m, most that the placement is corrected
  double correct_angle = 0.349066;                       // rad (20°)
  double correct_speed = 0.15;                           // m/s, at which the correction may change
  double correct_turn_speed = 1.5;                       // rad/s
  double closing_speed = 1.0;    // rad/s, of fingers that close on a known object
  double yield = 0.006;          // m, from the object, where a finger makes the hand yield
  double base_speed = 1.0;       // m/s, of the hand's base
  double base_turn_speed = 3.0;  // rad/s
  Duration longest_step = std::chrono::milliseconds(100);  // motion of one command, at most
  GripOptions grip;
};

/// From postures, detections and robot states to commands. Pure and deterministic; time comes as
/// values. Every command keeps the velocity limits relative to the one before, whatever happens;
/// the first one starts from where the robot hand is. Keeps references to the hand and the model.
class Mapping {
 public:
  /// Fails when the hand does not allow the mode of the fingers.
  static Expected<Mapping> create(const model::HandModel& hand, const MappingModel& model,
                                  const MappingOptions& options);

  /// Changes how it answers from now on; the hand goes there no faster than it may. Fails, and
  /// leaves all as it was, when the hand does not allow the mode of the fingers.
  Expected<void> use(FingerMode fingers, bool intelligent, bool place);

  /// The answer to a posture; call tick() too. The error's `what` is a short reason to count: bad
  /// postures are not answered, so the hand holds still. now: when the posture arrived.
  Expected<Command> on_posture(const Posture& posture, Time now);
  /// Refuses what is not finite or has no valid shape.
  Expected<void> on_detection(const Detection& detection);
  void on_detection_gone(std::uint32_t track);
  /// Refuses what has not this hand's sizes or is not finite.
  Expected<void> on_state(const RobotState& state);
  /// A command to stay, once no posture has been answered for `silence`.
  std::optional<Command> tick(Time now);

  Phase phase() const { return arbitration_.phase(); }

 private:
  /// An object with how much its size has varied from picture to picture.
  struct Track {
    Detection detection;
    double size = 0, size_variance = 0;  // m, m²: characteristic_size, recent ones count more
  };
  struct Candidate {
    Detection detection;
    double trust = 1;                                // most that the intelligent answer may count
    double distance = 0;                             // m, to its nearest grasp
    Pose X_WG;                                       // that grasp
    Pose X_OG;                                       // the same on the object
    Eigen::Vector3d p_GR = Eigen::Vector3d::Zero();  // m: where this hand stands in it
  };
  Mapping(const model::HandModel& hand, const MappingModel& model, const MappingOptions& options);
  Expected<Eigen::VectorXd> without_object(const Posture& posture, const Answer& joints,
                                           Duration elapsed);
  bool start(const Pose& X_WG, Time stamp, Time now);
  double trust(const Track& track) const;
  std::optional<Candidate> candidate(const Track& track, const Pose& X_WG, bool engaged) const;
  std::optional<Candidate> choose(const Pose& X_WG, Time now);
  Pose corrected(const Pose& X_WG, const std::optional<Candidate>& seen, Duration elapsed);
  double mean_closing(const Eigen::VectorXd& dof) const;
  void update_trust(const std::optional<Candidate>& seen, Duration elapsed);
  double weight() const { return std::min(arbitration_.weight(), trust_); }
  double yielding(const Pose& X_WG) const;
  bool closed_on_object(const Eigen::VectorXd& dof) const;
  Pose toward(const Pose& X_WG, const Pose& X_WG_grasp) const;
  void move_toward(const Eigen::VectorXd& dof, const Pose& X_WB, double together, Duration elapsed);

  const model::HandModel& hand_;
  const MappingModel& model_;
  MappingOptions options_;
  std::optional<retargeting::Retargeter> retargeter_;
  double precision_ = 0;  // of the combined mode: share of the fingertips' answer
  Arbitration arbitration_;
  Grip grip_;
  Arrival arrival_;
  FollowThrough follow_through_;
  RightOfWay right_of_way_;
  std::map<std::uint32_t, Track> tracks_;
  std::optional<Candidate> engaged_;         // the object that the weight is for
  double trust_ = 0;                         // in the engaged object; moves like the weight
  double yielded_ = 0;                       // m, along y of the object's grasp: see yielding()
  Pose full_correction_ = Pose::Identity();  // X_GG', for weight 1, as last seen
  Pose correction_ = Pose::Identity();       // X_GG' in force
  std::optional<RobotState> state_;
  std::optional<Time> first_posture_, last_answer_, last_hold_;
  Time time_{};      // that the last command is for
  Command command_;  // the last one; dof empty before the first
};

}  // namespace prehend::mapping
