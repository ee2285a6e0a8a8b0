#pragma once

#include <prehend/idl/GlovePubSubTypes.h>
#include <prehend/idl/OperationPubSubTypes.h>
#include <prehend/idl/PerceptionPubSubTypes.h>
#include <prehend/idl/RobotPubSubTypes.h>
#include <prehend/idl/WorldPubSubTypes.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

namespace prehend::dds {

/// What a process is in a lab. Keys are made for roles (`prehend keys`).
enum class Role : std::uint16_t {
  glove = 1 << 0,
  recognition = 1 << 1,
  mapping = 1 << 2,
  simulation = 1 << 3,
  robot = 1 << 4,
  recorder = 1 << 5,   // reads everything
  replayer = 1 << 6,   // stands for any writer; also checks what others answer
  operator_ = 1 << 7,  // gives orders: `prehend teach`
  viewer = 1 << 8,     // reads everything, writes nothing
};
inline constexpr std::array<std::pair<Role, std::string_view>, 9> role_names{{
    {Role::glove, "glove"},
    {Role::recognition, "recognition"},
    {Role::mapping, "mapping"},
    {Role::simulation, "simulation"},
    {Role::robot, "robot"},
    {Role::recorder, "recorder"},
    {Role::replayer, "replayer"},
    {Role::operator_, "operator"},
    {Role::viewer, "viewer"},
}};

/// A set of roles.
struct Roles {
  std::uint16_t bits = 0;
  constexpr Roles() = default;
  constexpr Roles(Role role) : bits(static_cast<std::uint16_t>(role)) {}
  constexpr bool has(Role role) const { return bits & static_cast<std::uint16_t>(role); }
  friend constexpr Roles operator|(Roles a, Roles b) {
    a.bits |= b.bits;
    return a;
  }
  constexpr bool operator==(const Roles&) const = default;
};
constexpr Roles operator|(Role a, Role b) {
  return Roles(a) | Roles(b);
}
/// Every process with a shell.
inline constexpr Roles services = Role::glove | Role::recognition | Role::mapping |
                                  Role::simulation | Role::robot | Role::recorder | Role::replayer |
                                  Role::operator_;
inline constexpr Roles anyone = services | Role::viewer;

/// What both sides of a topic must agree on. The same table stands in idl/README.md.
struct TopicQos {
  std::string_view name;
  bool reliable = true;
  bool transient_local = false;
  /// Samples kept by a writer and by a reader for each instance; 0: all.
  int writer_depth = 1;
  int reader_depth = 1;
  bool exclusive = false;                 // one writer at a time moves an instance
  std::chrono::milliseconds deadline{0};  // 0: none
  std::chrono::milliseconds lifespan{0};  // 0: for ever
  Roles from = {}, to = {};               // who writes it, who reads it
};

/// Beside those of the table, a replayer writes every topic, and who only looks reads every one.
constexpr bool may_write(Role role, const TopicQos& topic) {
  return topic.from.has(role) || role == Role::replayer;
}
constexpr bool may_read(Role role, const TopicQos& topic) {
  return topic.to.has(role) || (Role::recorder | Role::replayer | Role::viewer).has(role);
}

inline constexpr std::array topic_table{
    TopicQos{.name = "glove/frame",
             .reliable = false,
             .writer_depth = 8,
             .reader_depth = 8,
             .from = Role::glove,
             .to = Role::glove},
    TopicQos{.name = "hand/posture",
             .writer_depth = 64,
             .reader_depth = 1,
             .from = Role::glove,
             .to = Role::mapping | Role::operator_},
    TopicQos{.name = "camera/image",
             .reliable = false,
             .from = Role::recognition,
             .to = Role::recognition},
    TopicQos{.name = "object/detection",
             .transient_local = true,
             .from = Role::recognition,
             .to = Role::mapping | Role::simulation},
    TopicQos{.name = "robot/command",
             .writer_depth = 64,
             .reader_depth = 1,
             .exclusive = true,
             .deadline = std::chrono::milliseconds(100),
             .lifespan = std::chrono::milliseconds(200),
             .from = Role::mapping,
             .to = Role::simulation | Role::robot},
    TopicQos{.name = "robot/state",
             .reliable = false,
             .from = Role::simulation | Role::robot,
             .to = anyone},
    TopicQos{
        .name = "scene/state", .transient_local = true, .from = Role::simulation, .to = anyone},
    TopicQos{.name = "object/state", .reliable = false, .from = Role::simulation, .to = anyone},
    TopicQos{.name = "grasp/report",
             .transient_local = true,
             .writer_depth = 256,
             .reader_depth = 0,
             .from = Role::simulation,
             .to = anyone},
    TopicQos{.name = "operator/command",
             .writer_depth = 0,
             .reader_depth = 0,
             .from = Role::operator_,
             .to = services},
    TopicQos{.name = "operator/reply",
             .writer_depth = 0,
             .reader_depth = 0,
             .from = services,
             .to = Role::operator_},
    TopicQos{.name = "lab/clock",
             .writer_depth = 0,
             .reader_depth = 0,
             .from = Role::replayer,
             .to = services},
    TopicQos{.name = "lab/progress",
             .writer_depth = 0,
             .reader_depth = 0,
             .from = services,
             .to = Role::replayer},
    TopicQos{.name = "lab/beacon", .reliable = false, .from = services, .to = services},
    TopicQos{.name = "service/status", .transient_local = true, .from = services, .to = anyone},
};

constexpr const TopicQos* find_topic(std::string_view name) {
  for (const TopicQos& entry : topic_table)
    if (entry.name == name) return &entry;
  return nullptr;
}

/// A topic with its type, so that a name is never paired with a wrong type.
template <class PubSub>
struct Topic {
  using PubSubType = PubSub;
  using Type = typename PubSub::type;
  std::string_view name;
};

inline constexpr Topic<v1::GloveFramePubSubType> glove_frame{"glove/frame"};
inline constexpr Topic<v1::HandPosturePubSubType> hand_posture{"hand/posture"};
inline constexpr Topic<v1::CameraImagePubSubType> camera_image{"camera/image"};
inline constexpr Topic<v1::ObjectDetectionPubSubType> object_detection{"object/detection"};
inline constexpr Topic<v1::HandCommandPubSubType> robot_command{"robot/command"};
inline constexpr Topic<v1::HandStatePubSubType> robot_state{"robot/state"};
inline constexpr Topic<v1::SceneStatePubSubType> scene_state{"scene/state"};
inline constexpr Topic<v1::ObjectStatePubSubType> object_state{"object/state"};
inline constexpr Topic<v1::GraspReportPubSubType> grasp_report{"grasp/report"};
inline constexpr Topic<v1::OperatorCommandPubSubType> operator_command{"operator/command"};
inline constexpr Topic<v1::OperatorReplyPubSubType> operator_reply{"operator/reply"};
inline constexpr Topic<v1::LabClockPubSubType> lab_clock{"lab/clock"};
inline constexpr Topic<v1::LabProgressPubSubType> lab_progress{"lab/progress"};
inline constexpr Topic<v1::ClockBeaconPubSubType> lab_beacon{"lab/beacon"};
inline constexpr Topic<v1::ServiceStatusPubSubType> service_status{"service/status"};

}  // namespace prehend::dds
