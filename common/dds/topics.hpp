#pragma once

#include <array>
#include <chrono>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "common/dds/topic.hpp"
#include "idl/ArmPubSubTypes.h"
#include "idl/DemonstrationPubSubTypes.h"
#include "idl/GlovePubSubTypes.h"
#include "idl/OperationPubSubTypes.h"
#include "idl/PerceptionPubSubTypes.h"
#include "idl/PlanningPubSubTypes.h"
#include "idl/RobotPubSubTypes.h"
#include "idl/TrainingPubSubTypes.h"
#include "idl/WorldPubSubTypes.h"

/// All topics, and the only place that lists them: readers, writers, permissions of keys, `check`,
/// `doctor` and `replay` take from here, and tests/unit/dds/topics_test.cpp compares the table of
/// idl/README.md and the calls of the services with it. How to add one: docs/recipes.md.
namespace prehend::dds {

inline constexpr Topic<v1::GloveFramePubSubType> glove_frame{
    {.name = "glove/frame",
     .qos = {.reliable = false, .writer_depth = 8, .reader_depth = 8},
     .writers = Role::glove,
     .readers = Role::glove,
     .rate = "of the device, 30 Hz"}};

inline constexpr Topic<v1::HandPosturePubSubType> hand_posture{
    {.name = "hand/posture",
     .qos = {.writer_depth = 64, .reader_depth = 1},
     .writers = Role::glove,
     .readers = Role::mapping | Role::demonstration | Role::operator_,
     .rate = "as glove/frame"}};

/// Of the moment: a button that was held when something was recorded orders nothing.
inline constexpr Topic<v1::GloveButtonPubSubType> glove_button{
    {.name = "glove/button",
     .qos = {.reliable = false},
     .writers = Role::glove,
     .readers = Role::simulation | Role::robot | Role::operator_,
     .open = true,
     .content = Content::order,
     .rate = "as glove/frame, of a device with buttons"}};

/// Touch never blocks motion: a sample that is lost is not repeated.
inline constexpr Topic<v1::GloveFeedbackPubSubType> glove_feedback{
    {.name = "glove/feedback",
     .qos = {.reliable = false, .deadline = std::chrono::milliseconds(100)},
     .writers = Role::mapping,
     .readers = Role::glove,
     .open = true,
     .rate = "as robot/touch"}};

inline constexpr Topic<v1::CameraImagePubSubType> camera_image{{.name = "camera/image",
                                                                .qos = {.reliable = false},
                                                                .writers = Role::recognition,
                                                                .readers = Role::recognition,
                                                                .rate = "10 Hz"}};

inline constexpr Topic<v1::ObjectDetectionPubSubType> object_detection{
    {.name = "object/detection",
     .qos = {.transient_local = true},
     .writers = Role::recognition,
     .readers = Role::mapping | Role::simulation | Role::demonstration | Role::planner,
     .rate = "as camera/image",
     .remark = "disposed when gone"}};

inline constexpr Topic<v2::GraspCandidatesPubSubType> grasp_candidates{
    {.name = "grasp/candidates",
     .qos = {.transient_local = true},
     .writers = Role::planner,
     .readers = Role::mapping | Role::performer,
     .open = true,
     .rate = "as more are found",
     .remark = "disposed when gone"}};

/// Ownership is shared: an exclusive reader would drop a second writer without a word, while the
/// gate of the robot (common/gate) refuses and names it.
inline constexpr Topic<v2::HandCommandPubSubType> robot_command{
    {.name = "robot/command",
     .qos = {.writer_depth = 64,
             .reader_depth = 1,
             .deadline = std::chrono::milliseconds(100),
             .lifespan = std::chrono::milliseconds(200)},
     .writers = Role::mapping | Role::performer,
     .readers = Role::simulation | Role::robot,
     .rate = "as hand/posture, at least 50 Hz while holding"}};

inline constexpr Topic<v1::HandStatePubSubType> robot_state{
    {.name = "robot/state",
     .qos = {.reliable = false},
     .writers = Role::simulation | Role::robot,
     .readers = Role::mapping | Role::performer | Role::replayer,
     .open = true,
     .rate = "100 Hz"}};

inline constexpr Topic<v1::HandTouchPubSubType> robot_touch{
    {.name = "robot/touch",
     .qos = {.reliable = false},
     .writers = Role::simulation | Role::robot,
     .readers = Role::mapping,
     .open = true,
     .rate = "100 Hz"}};

inline constexpr Topic<v1::GateStatePubSubType> robot_gate{
    {.name = "robot/gate",
     .qos = {.transient_local = true},
     .writers = Role::simulation | Role::robot,
     .readers = Role::mapping | Role::performer | Role::operator_,
     .open = true,
     .content = Content::process,
     .rate = "on change, 1 Hz",
     .remark = "not in lockstep"}};

/// What leads the arm stands behind the gate of the robot, beside it.
inline constexpr Topic<v1::ArmCommandPubSubType> arm_command{
    {.name = "arm/command",
     .qos = {.writer_depth = 64,
             .reader_depth = 1,
             .deadline = std::chrono::milliseconds(100),
             .lifespan = std::chrono::milliseconds(200)},
     .writers = Role::simulation | Role::robot,
     .readers = Role::robot,
     .open = true,
     .rate = "100 Hz, of a robot with an arm"}};

inline constexpr Topic<v1::ArmStatePubSubType> arm_state{
    {.name = "arm/state",
     .qos = {.reliable = false},
     .writers = Role::simulation | Role::robot,
     .readers = Role::performer,
     .open = true,
     .rate = "100 Hz, of a robot with an arm"}};

inline constexpr Topic<v1::SceneStatePubSubType> scene_state{{.name = "scene/state",
                                                              .qos = {.transient_local = true},
                                                              .writers = Role::simulation,
                                                              .open = true,
                                                              .rate = "on change"}};

inline constexpr Topic<v1::ObjectStatePubSubType> object_state{
    {.name = "object/state",
     .qos = {.reliable = false},
     .writers = Role::simulation,
     .readers = Role::demonstration | Role::performer,
     .open = true,
     .rate = "100 Hz"}};

inline constexpr Topic<v1::GraspReportPubSubType> grasp_report{
    {.name = "grasp/report",
     .qos = {.transient_local = true, .writer_depth = 256, .reader_depth = 0},
     .writers = Role::simulation,
     .open = true,
     .rate = "a grasp"}};

inline constexpr Topic<v1::DemonstratedGraspPubSubType> demonstration_grasp{
    {.name = "demonstration/grasp",
     .qos = {.writer_depth = 64, .reader_depth = 1},
     .writers = Role::demonstration,
     .readers = Role::recognition,
     .open = true,
     .rate = "as hand/posture"}};

inline constexpr Topic<v1::DemonstratedSegmentPubSubType> demonstration_segment{
    {.name = "demonstration/segment",
     .qos = {.writer_depth = 64, .reader_depth = 64},
     .writers = Role::demonstration,
     .open = true,
     .rate = "a phase"}};

inline constexpr Topic<v1::TaskModelPubSubType> task_model{{.name = "task/model",
                                                            .qos = {.transient_local = true},
                                                            .writers = Role::demonstration,
                                                            .open = true,
                                                            .rate = "a demonstration"}};

inline constexpr Topic<v1::TaskProgressPubSubType> task_progress{
    {.name = "task/progress",
     .qos = {.transient_local = true},
     .writers = Role::performer,
     .open = true,
     .rate = "10 Hz while a task is done"}};

inline constexpr Topic<v1::TrainingProgressPubSubType> mapping_training{
    {.name = "mapping/training",
     .qos = {.transient_local = true},
     .writers = Role::mapping,
     .open = true,
     .content = Content::process,
     .rate = "5 Hz while somebody teaches"}};

inline constexpr Topic<v1::OperatorCommandPubSubType> operator_command{
    {.name = "operator/command",
     .qos = {.writer_depth = 0, .reader_depth = 0},
     .writers = Role::operator_ | Role::console,
     .readers = Role::mapping | Role::simulation | Role::demonstration | Role::performer |
                Role::robot | Role::recorder | Role::replayer,
     .content = Content::order,
     .rate = "on demand"}};

inline constexpr Topic<v1::OperatorReplyPubSubType> operator_reply{
    {.name = "operator/reply",
     .qos = {.writer_depth = 0, .reader_depth = 0},
     .writers = Role::mapping | Role::simulation | Role::demonstration | Role::performer |
                Role::robot | Role::recorder | Role::replayer,
     .readers = Role::operator_,
     .content = Content::order,
     .rate = "a command"}};

inline constexpr Topic<v1::OperatorConsentPubSubType> operator_consent{
    {.name = "operator/consent",
     .qos = {.reliable = false, .deadline = std::chrono::milliseconds(100)},
     .writers = Role::operator_ | Role::console,
     .readers = Role::simulation | Role::robot,
     .content = Content::order,
     .rate = "50 Hz while asked"}};

inline constexpr Topic<v2::LabClockPubSubType> lab_clock{
    {.name = "lab/clock",
     .qos = {.writer_depth = 0, .reader_depth = 0},
     .writers = Role::replayer,
     .readers = services,
     .content = Content::lockstep,
     .rate = "a lockstep cycle"}};

inline constexpr Topic<v1::LabProgressPubSubType> lab_progress{
    {.name = "lab/progress",
     .qos = {.writer_depth = 0, .reader_depth = 0},
     .writers = services,
     .readers = Role::replayer,
     .content = Content::lockstep,
     .rate = "a cycle"}};

inline constexpr Topic<v1::ClockBeaconPubSubType> lab_beacon{{.name = "lab/beacon",
                                                              .qos = {.reliable = false},
                                                              .writers = services,
                                                              .readers = services,
                                                              .content = Content::process,
                                                              .rate = "1 Hz",
                                                              .remark = "not in lockstep"}};

inline constexpr Topic<v1::ServiceSettingsPubSubType> service_settings{
    {.name = "service/settings",
     .qos = {.transient_local = true},
     .writers = services,
     .open = true,
     .content = Content::process,
     .rate = "once"}};

inline constexpr Topic<v1::ServiceStatusPubSubType> service_status{
    {.name = "service/status",
     .qos = {.transient_local = true},
     .writers = services,
     .open = true,
     .content = Content::process,
     .rate = "1 Hz"}};

/// In the order of the table in idl/README.md. What is not here has no reader and no writer
/// (a static_assert of Participant).
inline constexpr std::tuple typed_topics{
    glove_frame,         hand_posture,          glove_button,     glove_feedback,
    camera_image,        object_detection,      grasp_candidates, robot_command,
    robot_state,         robot_touch,           robot_gate,       arm_command,
    arm_state,           scene_state,           object_state,     grasp_report,
    demonstration_grasp, demonstration_segment, task_model,       task_progress,
    mapping_training,    operator_command,      operator_reply,   operator_consent,
    lab_clock,           lab_progress,          lab_beacon,       service_settings,
    service_status};

template <class PubSub>
inline constexpr bool is_listed = std::apply(
    [](const auto&... topics) {
      return (std::is_same_v<std::decay_t<decltype(topics)>, Topic<PubSub>> || ...);
    },
    typed_topics);

inline constexpr auto topic_table = std::apply(
    [](const auto&... topics) { return std::array<TopicInfo, sizeof...(topics)>{topics...}; },
    typed_topics);

constexpr const TopicInfo* find_topic(std::string_view name) {
  for (const TopicInfo& topic : topic_table)
    if (topic.name == name) return &topic;
  return nullptr;
}

}  // namespace prehend::dds
