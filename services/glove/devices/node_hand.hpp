#pragma once

#include "common/serial/plug.hpp"
#include "services/glove/devices/device.hpp"
#include "services/glove/devices/emulator.hpp"

namespace prehend::glove {

/// A bare hand that a node of ROS 2 tracks: 21, 25 or 26 joints (landmark_line.hpp has their order)
/// as geometry_msgs/PoseArray on the topic options.port; empty: node_hand_topic. The frame is the
/// tracker's, the hand that of options.left.
Expected<std::unique_ptr<Device>> create_node_hand(const DeviceOptions& options);

/// Such a node, without its camera.
std::unique_ptr<Emulator> emulate_node_hand(const DeviceOptions& options);
/// Where it is plugged in.
Expected<std::unique_ptr<serial::Plug>> plug_into_node_hand(const DeviceOptions& options);

inline constexpr const char* node_hand_topic = "hand_joints";

}  // namespace prehend::glove
