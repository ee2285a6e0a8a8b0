#pragma once

#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/recording/types/type.hpp"

/// Descriptions of a type for those who do not have our IDL: one self-contained text each.
namespace prehend::recording::types {

/// The name that readers of `ros2msg` expect: prehend::v1::Pose is prehend_v1/msg/Pose.
std::string ros2_name(std::string_view scoped_name);

/// ROS 2 and readers of its descriptions refuse field names with capitals: X_WH is x_wh there.
std::string ros2_field_name(std::string_view name);

/// For the schema encoding `ros2msg`: the type, then each type it needs behind a line of = signs
/// and «MSG: name». Enumerations are uint32 behind constants of the same type.
std::string ros2msg(const Structure& type);

/// For the schema encoding `omgidl`, where the schema's name is the scoped one.
std::string omgidl(const Structure& type);

/// Reads such a `ros2msg` text, ours or another's. Constants are passed by. The type is added under
/// `name` as it stands in the schema.
Expected<const Structure*> parse_ros2msg(std::string_view name, std::string_view text,
                                         Library& library);

}  // namespace prehend::recording::types
