#pragma once

#include <string>
#include <string_view>

/// Where this clone and its build are. One source knows, so that a compiler cache serves all
/// clones.
namespace prehend::test {

/// path: from the top of the sources; empty: the top itself.
std::string in_sources(std::string_view path);
/// The programs of the build: a name, or empty for their folder.
std::string in_programs(std::string_view name);
/// What those read: models, grasps and networks that were trained.
std::string in_share(std::string_view path);

}  // namespace prehend::test
