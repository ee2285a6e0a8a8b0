#pragma once

#include <string_view>

#include "common/base/error.hpp"
#include "services/recorder/service/recording_file.hpp"

namespace prehend::recorder {

/// Describes the types of the lab's IDL; `encoding` is ros2msg or omgidl.
Expected<decltype(Heading::describe)> describe_types(std::string_view encoding);

/// Finds keys in messages of the types of the lab's IDL; nothing for other types.
Expected<std::function<dds::KeyOf(const std::string& type)>> keys_of_types();

}  // namespace prehend::recorder
