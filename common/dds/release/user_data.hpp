#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/dds/release/fastdds.hpp"
#include "common/dds/release/role.hpp"

namespace prehend::dds {

/// What this process speaks with.
inline constexpr std::string_view own_middleware = "Fast DDS " PREHEND_FAST_DDS_RELEASE;

/// What a participant announces of itself in its user data: «Fast DDS 2.9.1; console». Whoever
/// hears of it knows both before anything that it writes.
struct UserData {
  std::string middleware;
  std::optional<Role> role;  // nothing: it announces none that we know
};

inline std::string own_user_data(std::string_view role) {
  return std::string(own_middleware) + "; " + std::string(role);
}

/// Reads what comes from the network; empty: it announces nothing of this kind.
inline UserData read_user_data(std::string_view text) {
  if (!text.starts_with("Fast DDS ")) return {};
  const std::size_t end = text.find("; ");
  if (end == std::string_view::npos) return {std::string(text), std::nullopt};
  return {std::string(text.substr(0, end)), role_named(text.substr(end + 2))};
}

}  // namespace prehend::dds
