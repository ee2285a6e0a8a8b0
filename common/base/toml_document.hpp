#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/error.hpp"

namespace prehend {

/// A TOML text. Refused, with its line: what is no TOML, and nan and inf, which TOML has and which
/// pass comparisons with bounds. where: whose text it is; hint: what is wanted.
Expected<toml::table> parse_toml(std::string_view text, const std::string& where,
                                 const std::string& hint = "it is TOML");

/// The same of a file. A folder is none.
Expected<toml::table> load_toml(const std::filesystem::path& file, const std::string& hint);

}  // namespace prehend
