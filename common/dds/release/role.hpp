#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

namespace prehend::dds {

/// What a process is in a lab. Keys are made for roles (`prehend keys`).
enum class Role : std::uint16_t {
  glove = 1 << 0,
  recognition = 1 << 1,
  mapping = 1 << 2,
  simulation = 1 << 3,
  robot = 1 << 4,
  recorder = 1 << 5,   // reads everything
  replayer = 1 << 6,   // stands for any writer; also checks what others answer
  operator_ = 1 << 7,  // gives orders: `prehend teach`
  viewer = 1 << 8,     // reads everything, writes nothing
  demonstration = 1 << 9,
  performer = 1 << 10,  // does tasks: `prehend tasks run`
  console = 1 << 11,    // reads everything, and gives the orders of its page
  planner = 1 << 12,    // says how the lab's hand may take what is seen
};
inline constexpr auto role_names = std::to_array<std::pair<Role, std::string_view>>({
    {Role::glove, "glove"},
    {Role::recognition, "recognition"},
    {Role::mapping, "mapping"},
    {Role::planner, "planner"},
    {Role::simulation, "simulation"},
    {Role::demonstration, "demonstration"},
    {Role::performer, "performer"},
    {Role::robot, "robot"},
    {Role::recorder, "recorder"},
    {Role::replayer, "replayer"},
    {Role::operator_, "operator"},
    {Role::viewer, "viewer"},
    {Role::console, "console"},
});
constexpr std::string_view name_of(Role role) {
  for (const auto& [each, name] : role_names)
    if (each == role) return name;
  return {};
}

/// The role of a service or key of this name: «mapping», «mapping-2».
constexpr std::optional<Role> role_named(std::string_view name) {
  for (const auto& [role, word] : role_names)
    if (name.starts_with(word) && (name.size() == word.size() || name[word.size()] == '-'))
      return role;
  return std::nullopt;
}

/// That of a certificate: of its unit (OU), or else of its name (CN). subject: as «/CN=a/OU=b», or
/// in the order of RFC 2253.
std::optional<Role> role_of_certificate(std::string_view subject);

/// A set of roles.
struct Roles {
  std::uint16_t bits = 0;
  constexpr Roles() = default;
  constexpr Roles(Role role) : bits(static_cast<std::uint16_t>(role)) {}
  constexpr bool has(Role role) const { return bits & static_cast<std::uint16_t>(role); }
  friend constexpr Roles operator|(Roles a, Roles b) {
    a.bits |= b.bits;
    return a;
  }
  constexpr bool operator==(const Roles&) const = default;
};
constexpr Roles operator|(Role a, Role b) {
  return Roles(a) | Roles(b);
}
/// Every process with a shell.
inline constexpr Roles services = Role::glove | Role::recognition | Role::mapping |
                                  Role::simulation | Role::demonstration | Role::performer |
                                  Role::robot | Role::recorder | Role::replayer | Role::operator_ |
                                  Role::console | Role::planner;

}  // namespace prehend::dds
