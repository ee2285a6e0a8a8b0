#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace prehend::test {

/// How another stack writes its messages.
enum class Stack { ros2msg, ros2idl, ros1, json, protobuf };
inline constexpr Stack all_stacks[] = {Stack::ros2msg, Stack::ros2idl, Stack::ros1, Stack::json,
                                       Stack::protobuf};

/// What sensor_msgs/JointState says.
struct Joints {
  std::vector<std::string> names;
  std::vector<double> position, velocity;
};
/// geometry_msgs/PoseStamped: x, y, z, then the quaternion x, y, z, w.
struct Place {
  double p[3] = {}, q[4] = {0, 0, 0, 1};
};

/// What sensor_msgs/Image says; blue first.
struct Raster {
  std::uint32_t width = 0, height = 0;
  std::string pixels;
};

struct Schema {
  std::string name, encoding, data;
};
Schema joints_schema(Stack stack);
Schema place_schema(Stack stack);
Schema picture_schema(Stack stack);
Schema raster_schema(Stack stack);
Schema yes_schema(Stack stack);        // std_msgs/Bool
std::string encoding_of(Stack stack);  // of messages

std::vector<std::uint8_t> message(Stack stack, const Joints& joints);
std::vector<std::uint8_t> message(Stack stack, const Place& place);
std::vector<std::uint8_t> picture_message(Stack stack, const std::string& bytes);
std::vector<std::uint8_t> message(Stack stack, const Raster& raster);
std::vector<std::uint8_t> yes_message(Stack stack, bool yes);

/// Two seconds of a robot of another stack from 1'700'000'000 s on: at each 20 ms, t seconds after
/// that, /joint_states with a = t and b = 2 t (in turns in the other order), /command with a = t +
/// 0.1 and b = 2 t + 0.1, /tool with the pose x = t, turned about z by t; /camera each
/// 100 ms with `picture`, if there is one, or with `raster`; /run, which is true from 0.2 to 0.9 s
/// and from 1.1 to 1.8 s.
void write_recording(const std::filesystem::path& file, Stack stack,
                     const std::string& picture = {}, const Raster& raster = {});

/// The columns of such a recording.
std::string columns_of_recording(bool pictures, const std::string& episodes = {});

}  // namespace prehend::test
