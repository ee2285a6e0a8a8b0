#include "common/dds/release/role.hpp"

namespace prehend::dds {
namespace {

/// What the subject says of an attribute; empty: nothing.
std::string_view attribute(std::string_view subject, std::string_view name) {
  while (!subject.empty()) {
    const std::size_t end = subject.find_first_of("/,");
    const std::string_view part = subject.substr(0, end);
    if (part.starts_with(name) && part.substr(name.size()).starts_with('='))
      return part.substr(name.size() + 1);
    if (end == std::string_view::npos) break;
    subject.remove_prefix(end + 1);
  }
  return {};
}

}  // namespace

std::optional<Role> role_of_certificate(std::string_view subject) {
  const std::string_view unit = attribute(subject, "OU");
  return role_named(unit.empty() ? attribute(subject, "CN") : unit);
}

}  // namespace prehend::dds
