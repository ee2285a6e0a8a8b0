#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/error.hpp"

namespace prehend {

/// The whole of a file, byte for byte. Fails with the system's reason, also for a folder and for
/// what cannot be read to its end; `hint` says what to do.
Expected<std::string> read_file(const std::filesystem::path& file,
                                const std::string& hint = "is the path right?");

/// Whoever reads the file meanwhile sees the old content or the new one, never half.
Expected<void> write_file(const std::filesystem::path& file, std::string_view content,
                          const std::string& hint = "check the folder and the disk");

}  // namespace prehend
