#pragma once

#include <string>

#include "services/recorder/tools/check/check.hpp"

namespace prehend::recorder {

/// What a check has found, for programs.
std::string to_json(const recording::Report& report);
/// The same for people.
std::string to_text(const Checked& checked);
/// As JUnit's XML, a test case a topic.
std::string to_junit(const std::string& name, const Checked& checked);

}  // namespace prehend::recorder
