#include "services/ros/core/diagnostics.hpp"

#include <string_view>

namespace prehend::ros {

ros2::Bytes diagnostics_message(std::int64_t stamp_ns, const Verdict& verdict) {
  ros2::CdrWriter made;
  made.stamp(stamp_ns);
  made.put(std::string_view());  // the frame
  made.put(std::uint32_t{1});
  made.put(static_cast<std::uint8_t>(verdict.good ? 0 : 1));
  made.put(verdict.name);
  made.put(verdict.message);
  made.put(verdict.hardware);
  made.put(static_cast<std::uint32_t>(verdict.values.size()));
  for (const auto& [key, value] : verdict.values) {
    made.put(key);
    made.put(value);
  }
  return std::move(made).bytes();
}

}  // namespace prehend::ros
