#pragma once

#include <string>
#include <vector>

#include "tests/architecture/house.hpp"

namespace prehend::architecture {

/// The house as two mermaid diagrams in Markdown: common, and the layers of the services, as the
/// includes have them. An edge that follows from two others is left out.
std::string drawing(const House& house);

/// Lines that stand around the drawing in ARCHITECTURE.md.
inline constexpr const char* drawing_begins = "<!-- drawing: made by draw_architecture -->";
inline constexpr const char* drawing_ends = "<!-- end of drawing -->";

/// The page with the drawing in its place; as it was when it has no such place.
std::string with_drawing(const std::string& page, const std::string& drawing);

}  // namespace prehend::architecture
