#include "common/base/log.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "common/base/printable.hpp"

namespace prehend::log {
namespace {

spdlog::logger& logger() {
  static const std::shared_ptr<spdlog::logger> instance = [] {
    auto made = spdlog::stderr_color_mt("prehend");
    made->set_pattern("%H:%M:%S.%e %^%l%$ %v");
    return made;
  }();
  return *instance;
}

std::string& name() {
  static std::string instance;
  return instance;
}

/// What others have said may be in it. Lines behind the first are set in: none looks like one of
/// ours.
std::string line(std::string_view text) {
  std::string shown = printable(text, "\n\t");
  for (std::size_t at = shown.find('\n'); at != std::string::npos; at = shown.find('\n', at + 1))
    shown.insert(at + 1, "  ");
  return name().empty() ? shown : fmt::format("[{}] {}", name(), shown);
}

}  // namespace

void set_name(std::string given) {
  name() = std::move(given);
}
void set_verbose(bool verbose) {
  logger().set_level(verbose ? spdlog::level::debug : spdlog::level::info);
}
void write_info(std::string_view text) {
  logger().info(line(text));
}
void write_warning(std::string_view text) {
  logger().warn(line(text));
}
void write_error(std::string_view text) {
  logger().error(line(text));
}
void write_debug(std::string_view text) {
  logger().debug(line(text));
}

}  // namespace prehend::log
