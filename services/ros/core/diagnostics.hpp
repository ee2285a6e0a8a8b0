#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/ros2/cdr.hpp"

namespace prehend::ros {

/// diagnostic_msgs/DiagnosticStatus, without its levels of errors: what is told here is a verdict.
struct Verdict {
  bool good = true;  // OK, or else WARN
  std::string name, message, hardware;
  std::vector<std::pair<std::string, std::string>> values;
};
/// diagnostic_msgs/DiagnosticArray with this one. Pure.
ros2::Bytes diagnostics_message(std::int64_t stamp_ns, const Verdict& verdict);

}  // namespace prehend::ros
