#include "common/recording/types/ros2idl.hpp"

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "common/recording/types/idl.hpp"

namespace prehend::recording::types {
namespace {

constexpr std::size_t max_parts = 256;

/// The files of a schema, without lines for a preprocessor.
std::vector<std::string> parts_of(std::string_view text) {
  std::vector<std::string> parts{""};
  std::istringstream lines{std::string(text)};
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("===") || line.starts_with("IDL:")) {
      if (!parts.back().empty()) parts.emplace_back();
      continue;
    }
    parts.back() += line.starts_with("#") ? "\n" : line + "\n";
  }
  return parts;
}

std::string scoped(std::string_view name) {
  std::string made;
  for (const char c : name) made += c == '/' ? std::string("::") : std::string(1, c);
  return made;
}

}  // namespace

Expected<const Structure*> parse_ros2idl(std::string_view name, std::string_view text,
                                         Library& library) {
  if (const Structure* known = library.find(scoped(name))) return known;
  std::vector<std::string> left = parts_of(text);
  if (left.size() > max_parts) return fail("its description has too many parts");
  // A part is read after those that it needs.
  Error reason{"its description lacks it", std::string(name), {}};
  for (bool further = true; further && !left.empty();) {
    further = false;
    std::vector<std::string> later;
    for (std::string& part : left) {
      if (const auto read = parse_idl(part, std::string(name), library)) {
        further = true;
      } else {
        reason = read.error();
        later.push_back(std::move(part));
      }
    }
    left = std::move(later);
  }
  if (const Structure* found = library.find(scoped(name))) return found;
  return tl::unexpected(reason);
}

}  // namespace prehend::recording::types
