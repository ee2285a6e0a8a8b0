#pragma once

#include <string_view>

#include "common/base/error.hpp"
#include "common/recording/types/type.hpp"

namespace prehend::recording::types {

/// Reads a schema of the encoding `ros2idl`: IDL files of ROS 2 in any order, each behind a line of
/// = signs and «IDL: name». `name` as it stands in the schema, sensor_msgs/msg/JointState.
Expected<const Structure*> parse_ros2idl(std::string_view name, std::string_view text,
                                         Library& library);

}  // namespace prehend::recording::types
