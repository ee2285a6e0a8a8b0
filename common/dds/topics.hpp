#pragma once

#include <prehend/idl/GlovePubSubTypes.h>
#include <prehend/idl/OperationPubSubTypes.h>
#include <prehend/idl/PerceptionPubSubTypes.h>
#include <prehend/idl/RobotPubSubTypes.h>
#include <prehend/idl/WorldPubSubTypes.h>

#include <array>
#include <chrono>
#include <optional>
#include <string_view>

namespace prehend::dds {

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
};

inline constexpr std::array topic_table{
    TopicQos{.name = "glove/frame", .reliable = false, .writer_depth = 8, .reader_depth = 8},
    TopicQos{.name = "hand/posture", .writer_depth = 64, .reader_depth = 1},
    TopicQos{.name = "camera/image", .reliable = false},
    TopicQos{.name = "object/detection", .transient_local = true},
    TopicQos{.name = "robot/command",
             .writer_depth = 64,
             .reader_depth = 1,
             .exclusive = true,
             .deadline = std::chrono::milliseconds(100),
             .lifespan = std::chrono::milliseconds(200)},
    TopicQos{.name = "robot/state", .reliable = false},
    TopicQos{.name = "scene/state", .transient_local = true},
    TopicQos{.name = "object/state", .reliable = false},
    TopicQos{.name = "grasp/report", .transient_local = true, .writer_depth = 0, .reader_depth = 0},
    TopicQos{.name = "operator/command", .writer_depth = 0, .reader_depth = 0},
    TopicQos{.name = "operator/reply", .writer_depth = 0, .reader_depth = 0},
    TopicQos{.name = "lab/clock", .writer_depth = 0, .reader_depth = 0},
    TopicQos{.name = "lab/progress", .writer_depth = 0, .reader_depth = 0},
    TopicQos{.name = "lab/beacon", .reliable = false},
    TopicQos{.name = "service/status", .transient_local = true},
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
