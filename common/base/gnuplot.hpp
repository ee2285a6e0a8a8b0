#pragma once

#include <filesystem>
#include <string>

#include "common/base/error.hpp"

namespace prehend {

/// Draws a picture by gnuplot: `commands` without its terminal and output, which are set here to a
/// PNG of that size. Fails, leaving no file, when gnuplot is missing or complains.
Expected<void> draw_by_gnuplot(const std::string& commands, const std::filesystem::path& png,
                               int width, int height);

}  // namespace prehend
