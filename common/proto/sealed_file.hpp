#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/base/error.hpp"

namespace prehend::proto {

/// A file of ours: one line «prehend KIND 1», the SHA-256 of the rest, the rest. A file that was
/// cut, flipped or belongs to something else is refused before anything looks at its contents.
Expected<void> write_sealed(const std::filesystem::path& file, std::string_view kind,
                            std::string_view bytes);
Expected<std::string> read_sealed(const std::filesystem::path& file, std::string_view kind);

/// The same in memory.
std::string seal(std::string_view kind, std::string_view bytes);
Expected<std::string> unseal(std::string_view sealed, std::string_view kind);

/// SHA-256 in hexadecimal.
std::string digest(std::string_view bytes);

}  // namespace prehend::proto
