#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "common/dds/participant.hpp"
#include "common/dds/raw.hpp"
#include "common/model/hand_model.hpp"
#include "common/service/shell.hpp"
#include "services/ros/core/one_speaker.hpp"
#include "services/ros/core/trajectory_follower.hpp"

namespace prehend::ros {

/// Leads the robot hand for nodes of ROS 2: their trajectories become commands, which the gate
/// before the hand judges as those of any leader. The base stays where it was when the lead began.
/// Whatever keeps the hand from following ends a trajectory; none is taken up again.
class Leader {
 public:
  /// Refused: lockstep, and nodes of a network in a lab with keys, since anybody may be a node.
  static Expected<std::unique_ptr<Leader>> create(service::Shell& shell);
  ~Leader();
  Leader(const Leader&) = delete;
  Leader& operator=(const Leader&) = delete;

 private:
  struct Robot {
    Eigen::VectorXd dof;
    Pose X_WB;
    Time heard;
  };

  Leader(service::Shell& shell, model::HandModel hand);
  Expected<void> join_nodes();
  void on_state(const v1::HandState& message);
  void on_trajectory(const dds::RawSample& sample);
  void on_wrist_pose(const dds::RawSample& sample);
  /// Counts a message of nodes, and what was wrong with it.
  void judged(const std::string& what, const Expected<void>& taken);
  void follow_at_once(const dds::RawSample& sample, Time now);
  void on_tick(Time now);
  /// What keeps the hand from being led.
  std::optional<Error> obstacle(Time now) const;
  void command(const Eigen::VectorXd& dof, Time now);
  void say(const std::string& trouble);

  service::Shell& shell_;
  const model::HandModel hand_;
  const std::string hand_name_;
  TrajectoryFollower follower_;
  service::Shell::Output<v2::HandCommand> commands_;
  std::optional<Robot> robot_;
  std::optional<v1::GateState> gate_;
  OneSpeaker<dds::GuidPrefix> nodes_heard_;
  Pose X_WB_ = Pose::Identity();  // where the lead began, or a node wants the base
  std::uint64_t sequence_ = 0;
  Time commanded_{}, at_once_{};
  std::int64_t origin_ns_ = 0;  // of the next command: when a node wrote what it follows; 0: before
  std::string missed_;          // why the last message was not followed to its end
  std::optional<std::string> trouble_;  // as was said
  std::optional<dds::Participant> nodes_;
  std::unique_ptr<dds::RawReader> trajectories_, wrist_poses_;
};

}  // namespace prehend::ros
