#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/error.hpp"

namespace prehend {

/// The text of a TOML file in which [table] has `line` («key = value») as its line of that key:
/// instead of the old one, or right behind the table's header, or in a new table at the end.
/// Everything else, comments too, stays as it was.
std::string with_line(std::string_view toml, std::string_view table, std::string_view key,
                      const std::string& line);

/// The same for a file; whoever reads it meanwhile sees the old one or the new one.
Expected<void> write_line(const std::filesystem::path& file, std::string_view table,
                          std::string_view key, const std::string& line);

}  // namespace prehend
