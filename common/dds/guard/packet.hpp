#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/dds/release/role.hpp"

namespace prehend::dds {

/// Whose an RTPS message is: the first 12 bytes of the identity of a participant and of everything
/// in it.
using GuidPrefix = std::array<std::uint8_t, 12>;
/// In the order in which it is written.
using Ipv4 = std::array<std::uint8_t, 4>;

/// What is said of a participant at its discovery (DDSI-RTPS 2.3, 8.5.3).
struct Announcement {
  GuidPrefix participant{};
  std::vector<Ipv4> addresses;  // at which it can be reached
  Duration lease{};             // it is gone when it has been silent for so long
  bool leaves = false;
  // What it says of itself, printable and cut to a length.
  std::string name, middleware;
  std::optional<Role> role;
  bool secured = false;                // it has keys
  std::string authority, certificate;  // of these, as DDS Security names them
};

/// An RTPS message, as far as it tells who speaks.
struct Packet {
  GuidPrefix sender{};
  std::vector<Announcement> announcements;  // of itself, or of others
  /// Something in it is said by, or of, another participant than the sender.
  bool for_others = false;
};

/// Reads a message; nothing, when it is not sound: a part does not lie within it (DDSI-RTPS 2.3,
/// 8.3.3 and 9.4.5), what it tells at discovery is no list of parameters (9.4.2.11), or a part of
/// Fast DDS's statistics is not the last, or not as long as Fast DDS makes it. As Debian builds it,
/// Fast DDS 2.9 ends the process over some of these. What is encrypted is not looked into.
std::optional<Packet> read_packet(std::span<const std::uint8_t> message);

/// The identity of `fast-discovery-server -i 0`; the third byte is the server's number.
inline constexpr GuidPrefix first_server{0x44, 0x53, 0x00, 0x5f, 0x45, 0x50,
                                         0x52, 0x4f, 0x53, 0x49, 0x4d, 0x41};
bool is_server(const GuidPrefix& prefix);

}  // namespace prehend::dds
