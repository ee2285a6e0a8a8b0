#include "common/base/log.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>

#include "common/base/log_format.hpp"
#include "common/base/printable.hpp"

namespace prehend::log {
namespace {

using Json = nlohmann::ordered_json;
using spdlog::level::level_enum;

/// UTC, so that the lines of all hosts sort together.
constexpr const char* text_pattern = "%Y-%m-%dT%H:%M:%S.%eZ %^%l%$ %v";
constexpr const char* json_pattern = R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l",%v})";

// Logger and setup are never destroyed: a thread of Fast DDS may still write while the program
// ends.

spdlog::logger& logger() {
  static const auto& instance = *new std::shared_ptr<spdlog::logger>([] {
    auto made = spdlog::stderr_color_mt("prehend");
    made->set_pattern(text_pattern, spdlog::pattern_time_type::utc);
    return made;
  }());
  return *instance;
}

/// Set by main(), before threads begin.
struct Setup {
  Format format = Format::text;
  std::string name, rig;
};
Setup& setup() {
  static Setup& instance = *new Setup;
  return instance;
}

/// What others have said may be in it. Lines behind the first are set in: none looks like one of
/// ours.
std::string text_line(std::string_view text) {
  std::string shown = printable(text, "\n\t");
  for (std::size_t at = shown.find('\n'); at != std::string::npos; at = shown.find('\n', at + 1))
    shown.insert(at + 1, "  ");
  return setup().name.empty() ? shown : fmt::format("[{}] {}", setup().name, shown);
}

/// The members behind time and level, which the pattern writes. In ASCII, so that no text that
/// others have said moves the cursor of a terminal.
std::string json_line(std::string_view text, const Error* error) {
  Json line{{"service", setup().name.empty() ? "prehend" : setup().name}};
  if (!setup().rig.empty()) line["rig"] = setup().rig;
  line["message"] = text;
  if (error) {
    line["what"] = error->what;
    if (!error->where.empty()) line["where"] = error->where;
    if (!error->hint.empty()) line["hint"] = error->hint;
  }
  const std::string object = line.dump(-1, ' ', true, Json::error_handler_t::replace);
  return object.substr(1, object.size() - 2);
}

void write(level_enum level, std::string_view text, const Error* error = nullptr) {
  if (!logger().should_log(level)) return;
  logger().log(level, setup().format == Format::json ? json_line(text, error) : text_line(text));
}

}  // namespace

void set_name(std::string name) {
  setup().name = std::move(name);
}
void set_verbose(bool verbose) {
  logger().set_level(verbose ? level_enum::debug : level_enum::info);
}

std::optional<Format> format_of(std::string_view name) {
  if (name == "text") return Format::text;
  if (name == "json") return Format::json;
  return std::nullopt;
}
void set_format(Format format) {
  setup().format = format;
  logger().set_pattern(format == Format::json ? json_pattern : text_pattern,
                       spdlog::pattern_time_type::utc);
}
Format format() {
  return setup().format;
}
void set_rig(std::string rig) {
  setup().rig = std::move(rig);
}

void write_info(std::string_view text) {
  write(level_enum::info, text);
}
void write_warning(std::string_view text) {
  write(level_enum::warn, text);
}
void write_error(std::string_view text) {
  write(level_enum::err, text);
}
void write_debug(std::string_view text) {
  write(level_enum::debug, text);
}
void error(const Error& error) {
  write(level_enum::err, error.message(), &error);
}
void warning(const Error& error) {
  write(level_enum::warn, error.message(), &error);
}

}  // namespace prehend::log
