#pragma once

#include <prehend/base/error.hpp>
#include <string_view>

#include "recording_file.hpp"

namespace prehend::recorder {

/// Describes the types of the lab's IDL; `encoding` is ros2msg or omgidl.
Expected<decltype(Heading::describe)> describe_types(std::string_view encoding);

}  // namespace prehend::recorder
