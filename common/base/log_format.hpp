#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/base/error.hpp"

/// How the lines of common/base/log.hpp look: for people, or one JSON object a line for programs.
namespace prehend::log {

enum class Format { text, json };
std::optional<Format> format_of(std::string_view name);

void set_format(Format format);
Format format();
/// Of the lab that the process takes part in; told in JSON.
void set_rig(std::string rig);

/// An error, whose parts JSON keeps apart as what, where and hint.
void error(const Error& error);
void warning(const Error& error);

}  // namespace prehend::log
