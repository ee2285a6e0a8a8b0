#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/base/time.hpp"
#include "common/model/grasp_candidates.hpp"
#include "common/model/hand_model.hpp"
#include "services/mapping/core/arbitration.hpp"
#include "services/mapping/core/clutch.hpp"
#include "services/mapping/core/direct_fingers.hpp"
#include "services/mapping/core/features.hpp"
#include "services/mapping/core/finger_distances.hpp"
#include "services/mapping/core/follow_through.hpp"
#include "services/mapping/core/grasp_type.hpp"
#include "services/mapping/core/grip_controller.hpp"
#include "services/mapping/core/hold_timer.hpp"
#include "services/mapping/core/mapping_model.hpp"
#include "services/mapping/core/mapping_modes.hpp"
#include "services/mapping/core/motion_limits.hpp"
#include "services/mapping/core/object_tracks.hpp"
#include "services/mapping/core/other_hands.hpp"
#include "services/mapping/core/placement.hpp"
#include "services/mapping/core/posture.hpp"
#include "services/mapping/core/target_selector.hpp"
#include "services/mapping/core/trust.hpp"

namespace prehend::mapping {

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
  /// How it answers at first; use() changes it.
  MappingModes modes;
  /// Which detections are known objects, and for how long.
  ObjectTrackOptions tracks;
  /// Which known object is within reach.
  TargetOptions target;
  /// How exact a detection must be to count fully.
  TrustOptions trust;
  /// How far and how fast a known object corrects where the hand goes.
  PlacementOptions placement;
  /// How the hand squeezes what stops its fingers.
  GripOptions grip;
  /// How far one command goes from the one before.
  MotionLimitOptions motion;
  /// How the hands come together again after an interruption.
  ClutchOptions clutch;
  /// When the hand is told to stay.
  HoldTimerOptions hold;
  /// What is blended (the intelligent answer, the trust in it, and the fingertips' share of the
  /// combined mode) goes from 0 to 1 in this time.
  Duration ramp = std::chrono::milliseconds(300);
  /// A posture that is older than this time, or as far in the future, is not answered.
  Duration max_posture_age = std::chrono::milliseconds(500);
  /// Without robot/state for this time from the first posture, it starts with an open hand.
  Duration state_wait = std::chrono::seconds(1);
  /// A robot hand that is somewhere already is not swept to where the operator is, as after any
  /// interruption; its gate says whether it is. In lockstep there is no gate, and no danger.
  bool start_slowly = false;
};

/// From postures, detections and robot states to commands. Pure and deterministic; time comes as
/// values. Every command keeps the velocity limits relative to the one before, whatever happens;
/// the first one starts from where the robot hand is, and so does the first one after it was
/// stopped or started anew. After an interruption the hands come together slowly (Clutch). Keeps
/// references to the hand and the model.
class Mapping {
 public:
  /// Fails when the hand does not allow the mode of the fingers.
  static Expected<Mapping> create(const model::HandModel& hand, const MappingModel& model,
                                  const MappingOptions& options);

  /// Changes how it answers from now on; the hand goes there no faster than it may. Fails, and
  /// leaves all as it was, when the hand does not allow the mode of the fingers.
  Expected<void> use(const MappingModes& modes);

  /// The answer to a posture; call tick() too. The error's `what` is a short reason to count: bad
  /// postures are not answered, so the hand holds still. now: when the posture arrived.
  Expected<Command> on_posture(const Posture& posture, Time now);
  /// Refuses what ObjectTracks::observe does.
  Expected<void> on_detection(const Detection& detection) { return tracks_.observe(detection); }
  void on_detection_gone(std::uint32_t track) { tracks_.remove(track); }
  /// Refuses what CandidateBook::observe does.
  Expected<void> on_candidates(model::GraspCandidates planned) {
    return planned_.observe(std::move(planned), hand_);
  }
  void on_candidates_gone(std::uint32_t track) { planned_.remove(track); }
  /// Refuses what has not this hand's sizes or is not finite.
  Expected<void> on_state(const RobotState& state);
  /// Whether the robot hand obeys anybody, as its gate says. While it does not, commands stay where
  /// it is. placed: it is somewhere already; nothing: nobody says so.
  void on_gate(bool obeys, std::optional<bool> placed = {});
  /// Another robot hand in the same world, which this one keeps off; capsules in W.
  void on_other_hand(const std::string& name, std::vector<Capsule> capsules) {
    others_.observe(name, std::move(capsules));
  }
  void on_other_hand_gone(const std::string& name) { others_.remove(name); }
  /// The next posture is of somebody else: the hands come together slowly.
  void interrupt() { interrupted_ = true; }
  /// A command to stay, once no posture has been answered for a while (HoldTimerOptions).
  std::optional<Command> tick(Time now);

  Phase phase() const { return arbitration_.phase(); }

 private:
  Mapping(const model::HandModel& hand, const MappingModel& model, const MappingOptions& options);

  // The steps of a posture, in order; numbers are those of README.md.
  Expected<Features> features_of(const Posture& posture, Time now) const;  // 1, 2
  bool start(const Pose& X_WG, Time stamp, Time now);                      // 3
  Pose clutch(const Pose& X_WG, Duration elapsed);                         // 4
  bool are_apart(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
  bool robot_is_elsewhere() const;
  void take_place_of_robot();
  std::optional<GraspTarget> select_target(const Pose& X_WG, Time now);  // 5, 6
  void weigh(const std::optional<GraspTarget>& seen, Duration elapsed);  // 7, 8
  Expected<NetworkAnswer> answer(const Posture& posture, const Features& features,
                                 Duration elapsed);                                        // 9, 10
  NetworkAnswer known_answer(const Features& features, const GraspTarget& target) const;   // 10
  void place(const Pose& X_WG, const std::optional<GraspTarget>& seen, Duration elapsed);  // 12, 13
  Eigen::VectorXd limited(const Eigen::VectorXd& dof) const;
  Eigen::VectorXd follow_through(const Eigen::VectorXd& dof, Duration elapsed);      // 14
  void move_toward(const Eigen::VectorXd& dof, const Pose& X_WB, Duration elapsed);  // 16, 17

  /// Of the intelligent answer, 0 to 1.
  double weight() const { return std::min(arbitration_.weight(), trust_.bound()); }
  /// The object that counts at all; nullptr: none.
  const GraspTarget* known_object() const;

  const model::HandModel& hand_;
  const MappingModel& model_;
  MappingOptions options_;
  FingerDistances distances_;
  ObjectTracks tracks_;
  model::CandidateBook planned_;
  TargetSelector targets_;
  Arbitration arbitration_;
  Trust trust_;
  DirectFingers direct_;
  Placement placement_;
  Clutch clutch_;
  FollowThrough follow_through_;
  GripController grip_;
  MotionLimits motion_;
  OtherHands others_;
  HoldTimer hold_;
  std::optional<RobotState> state_;
  std::optional<Time> first_posture_;
  bool interrupted_ = false;       // since the last posture that was answered
  bool obeyed_ = true;             // by the robot hand, as its gate says
  std::optional<bool> placed_;     // the robot hand is somewhere, as its gate says
  std::optional<Pose> last_X_WG_;  // of that posture
  Time last_stamp_{};              // of that posture
  Time time_{};                    // that the last command is for
  Command command_;                // the last one; dof empty before the first
};

}  // namespace prehend::mapping
