#include "services/ros/tools/lead/leader.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "common/base/log.hpp"
#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "common/ros2/joints.hpp"
#include "common/ros2/nodes/nodes.hpp"
#include "common/service/status_publisher.hpp"
#include "services/ros/core/wrist_goal.hpp"

namespace prehend::ros {
namespace {

constexpr Duration period = std::chrono::milliseconds(10);  // of commands
constexpr Duration apart = std::chrono::milliseconds(1);    // messages that are followed at once
constexpr Duration silence = std::chrono::seconds(2);       // of the robot

/// As the gate calls us, once it knows our name.
std::string own_name() {
  return fmt::format("ros-lead@{}/{}", service::host_name(), ::getpid());
}

/// When a node wrote it; its clock may be another than ours.
Time written(const dds::RawSample& sample) {
  return std::clamp(sample.sent, sample.received - std::chrono::seconds(1), sample.received);
}

/// Whatever a node writes with has the same beginning.
dds::GuidPrefix node_of(const dds::RawSample& sample) {
  dds::GuidPrefix node{};
  std::copy_n(sample.writer.begin(), node.size(), node.begin());
  return node;
}

}  // namespace

Expected<std::unique_ptr<Leader>> Leader::create(service::Shell& shell) {
  const service::Config& config = shell.config();
  if (shell.lockstep())
    return wrong_use("nodes of ROS 2 cannot lead in lockstep", "lab.lockstep",
                     "set lab.lockstep to false");
  const std::string& kind = config.text("mapping.hand");
  if (kind.empty()) return wrong_use("names no hand", "mapping.hand", model::hand_hint());
  auto hand = model::HandModel::load(model::hand_directory(kind));
  if (!hand) return tl::unexpected(hand.error());
  std::unique_ptr<Leader> made(new Leader(shell, std::move(*hand)));
  if (auto joined = made->join_nodes(); !joined) return tl::unexpected(joined.error());
  return made;
}

Leader::Leader(service::Shell& shell, model::HandModel hand)
    : shell_(shell),
      hand_(std::move(hand)),
      hand_name_(shell.config().text("mapping.hand_name")),
      follower_(hand_),
      commands_(shell.publish(dds::robot_command)) {
  shell.subscribe(dds::robot_state,
                  std::function([this](const v1::HandState& state, const dds::SampleInfo& info) {
                    if (!info.gone && state.hand().to_string() == hand_name_) on_state(state);
                  }));
  shell.subscribe(dds::robot_gate,
                  std::function([this](const v1::GateState& state, const dds::SampleInfo& info) {
                    if (state.hand().to_string() != hand_name_) return;
                    gate_ = info.gone ? std::nullopt : std::optional(state);
                  }));
  shell.busy_while([this] { return follower_.goal(shell_.now()).has_value(); });
  shell.on_tick(period, [this](Time now) { on_tick(now); });
}

Leader::~Leader() {
  // What still receives calls us.
  trajectories_.reset();
  wrist_poses_.reset();
}

Expected<void> Leader::join_nodes() {
  const auto domain = ros2::domain_of_nodes();
  if (!domain) return tl::unexpected(domain.error());
  const service::Config& config = shell_.config();
  const auto network =
      ros2::network_of_leaders(config.text("ros.network"), !config.path("lab.keys").empty());
  if (!network) return tl::unexpected(network.error());
  auto joined = ros2::join_nodes("prehend_ros_lead", *domain, *network);
  if (!joined) return tl::unexpected(joined.error());
  nodes_.emplace(std::move(*joined));
  const auto read = [this](const std::string& topic, const char* type,
                           void (Leader::*take)(const dds::RawSample&)) {
    return dds::RawReader::create(*nodes_, ros2::topic_of_nodes(topic, type),
                                  [this, take](dds::RawSample&& sample) {
                                    if (sample.kind == dds::RawSample::Kind::data)
                                      shell_.exclusively([&] { (this->*take)(sample); });
                                  });
  };
  const std::string& trajectories = shell_.config().text("ros.trajectories");
  auto reader = read(trajectories, "trajectory_msgs/JointTrajectory", &Leader::on_trajectory);
  if (!reader) return tl::unexpected(reader.error());
  trajectories_ = std::move(*reader);
  const std::string& poses = shell_.config().text("ros.wrist_poses");
  reader = read(poses, "geometry_msgs/PoseStamped", &Leader::on_wrist_pose);
  if (!reader) return tl::unexpected(reader.error());
  wrist_poses_ = std::move(*reader);
  log::info("trajectories of nodes are taken on /{}, poses of the hand on /{}, domain {} of ROS 2",
            trajectories, poses, *domain);
  return {};
}

void Leader::on_state(const v1::HandState& message) {
  const auto X_WB = convert::from_message(message.X_WB());
  const Eigen::VectorXd dof = convert::from_message(message.dof());
  if (message.model().to_string() != hand_.name() || !X_WB || !dof.allFinite() ||
      dof.size() != static_cast<Eigen::Index>(hand_.dofs().size()))
    return shell_.status().drop("state of the robot not usable");
  robot_ = {dof, *X_WB, shell_.now()};
}

std::optional<Error> Leader::obstacle(Time now) const {
  if (!robot_ || now - robot_->heard > silence)
    return Error{"no robot hand is there", hand_name_,
                 "a " + hand_.name() + ", see prehend status"};
  if (!gate_) return Error{"no gate of a robot answers", hand_name_, "see prehend status"};
  if (gate_->stopped())
    return Error{"is stopped by " + gate_->stopped_by().to_string(), hand_name_,
                 "prehend release --reason WHY"};
  if (gate_->deadman() && !gate_->consent())
    return Error{"waits for consent", hand_name_, "prehend consent"};
  const std::string leader = gate_->leader().to_string();
  const bool named = leader.find('@') != std::string::npos;
  // Who has no name yet may be ourselves, if we lead.
  if (!leader.empty() && (named ? leader != own_name() : !follower_.goal(now)))
    return Error{"is led by " + leader, hand_name_, "stop that one first"};
  return std::nullopt;
}

void Leader::on_trajectory(const dds::RawSample& sample) {
  const Time now = shell_.now();
  const bool leads = follower_.goal(now).has_value();
  const auto taken =
      ros2::parse_joint_trajectory(sample.payload)
          .and_then([&](const ros2::JointTrajectory& trajectory) -> Expected<void> {
            if (!trajectory.points.empty()) {  // anybody may end it
              if (auto error = obstacle(now)) return tl::unexpected(*error);
              const auto heard = nodes_heard_.hear(node_of(sample), now);
              if (!heard) return heard;
            }
            return follower_.take(trajectory, robot_ ? robot_->dof : Eigen::VectorXd(), now);
          });
  if (taken && !leads && robot_) X_WB_ = robot_->X_WB;
  judged("trajectory", taken);
  if (taken) follow_at_once(sample, now);
}

void Leader::on_wrist_pose(const dds::RawSample& sample) {
  const Time now = shell_.now();
  const auto taken =
      ros2::parse_pose_stamped(sample.payload)
          .and_then([&](const ros2::StampedPose& pose) { return wrist_goal(pose, now); })
          .and_then([&](const Pose& X_WB) -> Expected<void> {
            if (auto error = obstacle(now)) return tl::unexpected(*error);
            const auto heard = nodes_heard_.hear(node_of(sample), now);
            if (!heard) return heard;
            follower_.hold(robot_->dof, now);
            X_WB_ = X_WB;
            return {};
          });
  judged("wrist pose", taken);
  if (taken) follow_at_once(sample, now);
}

/// Who leads by a stream of messages waits for no tick; one that comes too soon after the last
/// does.
void Leader::follow_at_once(const dds::RawSample& sample, Time now) {
  const auto goal = follower_.goal(now);
  if (!goal) return;
  origin_ns_ = to_ns(written(sample));
  if (now - at_once_ < apart) return;
  at_once_ = now;
  command(*goal, now);
}

void Leader::judged(const std::string& what, const Expected<void>& taken) {
  shell_.status().count(what == "trajectory" ? "trajectories" : "wrist poses");
  if (!taken) shell_.status().drop(what + " refused");
  missed_ = taken ? "" : fmt::format("the last {} was refused: {}", what, taken.error().message());
}

void Leader::on_tick(Time now) {
  const auto error = obstacle(now);
  if (const auto goal = follower_.goal(now)) {
    if (error) {
      follower_.stop();
      shell_.status().drop("trajectory ended");
      missed_ = "the lead of a node was ended: " + error->message();
    } else if (now - commanded_ >= period / 2) {
      command(*goal, now);
    }
  }
  say(!missed_.empty() ? missed_ : error ? error->message() : "");
}

void Leader::command(const Eigen::VectorXd& dof, Time now) {
  v2::HandCommand message;
  message.hand(hand_name_);
  message.model(hand_.name());
  message.sequence_number(++sequence_);
  message.stamp_ns(to_ns(now));
  message.origin_ns(std::exchange(origin_ns_, 0));
  message.dof(convert::to_message(dof));
  message.X_WB(convert::to_message(X_WB_));
  message.mode(v1::MODE_DIRECT);
  commands_.publish(message);
  commanded_ = now;
}

void Leader::say(const std::string& trouble) {
  if (trouble == trouble_) return;
  trouble_ = trouble;
  if (trouble.empty()) return shell_.status().running();
  log::warning("{}", trouble);
  shell_.status().degraded(trouble);
}

}  // namespace prehend::ros
