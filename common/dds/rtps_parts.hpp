#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

/// An RTPS message on the wire (DDSI-RTPS 2.3): for those who look into it before the middleware.
namespace prehend::dds::wire {

using Bytes = std::span<const std::uint8_t>;

// Kinds of parts (9.4.5.1.1).
constexpr std::uint8_t pad = 0x01, info_timestamp = 0x09;  // may say a length of 0 and mean it
constexpr std::uint8_t info_source = 0x0c, data = 0x15, data_fragment = 0x16;
constexpr std::uint8_t acknack = 0x06, heartbeat = 0x07, gap = 0x08, nack_fragment = 0x12,
                       heartbeat_fragment = 0x13;
constexpr std::uint8_t first_secured = 0x30, last_secured = 0x34;  // DDS Security 1.1, 7.3.6
constexpr std::uint8_t statistics = 0x80;                          // of Fast DDS

constexpr std::size_t header_size = 20, part_header_size = 4;
constexpr std::size_t min_data_size = 20, min_fragment_size = 32;

// Flags of data.
constexpr std::uint8_t little_endian_flag = 0x01, parameters_flag = 0x02, data_flag = 0x04,
                       key_flag = 0x08;
// Who writes what discovery tells (9.3.1.5), in the order of the bytes.
constexpr std::uint32_t participants = 0x000100c2, topics = 0x000002c2, writers = 0x000003c2,
                        readers = 0x000004c2, liveliness = 0x000200c2;
constexpr std::uint32_t participants_reader = 0x000100c7;
// Parameters (9.6.3.2).
constexpr std::uint16_t end_of_list = 0x0001, lease_duration = 0x0002, default_locator = 0x0031,
                        metatraffic_locator = 0x0032, participant_guid = 0x0050,
                        endpoint_guid = 0x005a, key_hash = 0x0070, status_info = 0x0071,
                        entity_name = 0x0062, participant_user_data = 0x002c,
                        identity_token = 0x1001, product_version = 0x8000;

/// Numbers in one order of bytes. The caller has seen to it that they are there.
struct Numbers {
  Bytes bytes;
  bool little_endian;
  std::uint16_t two(std::size_t at) const {
    const std::uint16_t a = bytes[at], b = bytes[at + 1];
    return static_cast<std::uint16_t>(little_endian ? a | b << 8 : a << 8 | b);
  }
  std::uint32_t four(std::size_t at) const {
    const std::uint32_t a = two(at), b = two(at + 2);
    return little_endian ? a | b << 16 : a << 16 | b;
  }
};

template <std::size_t n>
std::array<std::uint8_t, n> array_at(Bytes bytes, std::size_t at) {
  std::array<std::uint8_t, n> part;
  std::copy_n(bytes.begin() + static_cast<long>(at), n, part.begin());
  return part;
}

/// Entities are not numbers: their bytes do not change places.
inline std::uint32_t entity_at(Bytes bytes, std::size_t at) {
  return Numbers{bytes, false}.four(at);
}

/// Does this parameter say that what it stands beside is disposed or unregistered (9.6.3.9)?
inline bool is_end(std::uint16_t parameter, Bytes value) {
  return parameter == status_info &&
         std::any_of(value.begin(), value.end(), [](std::uint8_t byte) { return byte != 0; });
}

/// Calls visit(parameter, its value) for each of a list and returns the list's length; nothing when
/// it has no end.
template <class Visit>
std::optional<std::size_t> for_each_parameter(const Numbers& list, Visit visit) {
  for (std::size_t at = 0; list.bytes.size() - at >= 4;) {
    const std::uint16_t parameter = list.two(at);
    const std::size_t length = list.two(at + 2);
    at += 4;
    if (parameter == end_of_list) return at;
    if (length > list.bytes.size() - at) return std::nullopt;
    visit(parameter, Numbers{list.bytes.subspan(at, length), list.little_endian});
    at = std::min(at + (length + 3) / 4 * 4, list.bytes.size());
  }
  return std::nullopt;
}

/// Calls visit(kind, flags, part, is it the last?) for each part until one is false. False: one
/// was, or a part does not lie within the message, or it is no message.
template <class Visit>
bool for_each_part(Bytes message, Visit visit) {
  constexpr std::string_view name = "RTPS";
  if (message.size() < header_size || !std::equal(name.begin(), name.end(), message.begin()))
    return false;
  for (std::size_t at = header_size; at < message.size();) {
    if (message.size() - at < part_header_size) return false;
    const std::uint8_t kind = message[at], flags = message[at + 1];
    std::size_t length = Numbers{message.subspan(at), (flags & little_endian_flag) != 0}.two(2);
    at += part_header_size;
    const std::size_t left = message.size() - at;
    // The last part may leave its length to the message's.
    if (length == 0 && kind != pad && kind != info_timestamp) length = left;
    if (length > left) return false;
    if (!visit(kind, flags, message.subspan(at, length), length == left)) return false;
    // Parts begin at multiples of four, those within a secured message where the last one ends.
    if (kind < first_secured || kind > last_secured) length = std::min((length + 3) / 4 * 4, left);
    at += length;
  }
  return true;
}

}  // namespace prehend::dds::wire
