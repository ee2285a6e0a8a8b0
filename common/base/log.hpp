#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

/// One line an event on standard error, so that standard output stays free for --json.
namespace prehend::log {

/// Name printed with every line; set once, by main().
void set_name(std::string name);
void set_verbose(bool verbose);

void write_info(std::string_view text);
void write_warning(std::string_view text);
void write_error(std::string_view text);
void write_debug(std::string_view text);

template <class... Args>
void info(fmt::format_string<Args...> format, Args&&... args) {
  write_info(fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void warning(fmt::format_string<Args...> format, Args&&... args) {
  write_warning(fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void error(fmt::format_string<Args...> format, Args&&... args) {
  write_error(fmt::format(format, std::forward<Args>(args)...));
}
template <class... Args>
void debug(fmt::format_string<Args...> format, Args&&... args) {
  write_debug(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace prehend::log
