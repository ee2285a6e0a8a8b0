#pragma once

#include <string>

#include "tests/architecture/house.hpp"

namespace prehend::architecture {

inline constexpr const char* decisions_page = "docs/decisions/README.md";

/// The index of the records in docs/decisions: each with its title and whether it holds. A record
/// says that it does not by a paragraph that begins with «**Overtaken:**», or «**Changed:**» where
/// a part of it does.
std::string decisions(const House& house);

}  // namespace prehend::architecture
