#include "common/dds/guard/plaintext.hpp"

#include "common/dds/guard/rtps_parts.hpp"

namespace prehend::dds {
namespace {

using namespace wire;

// Who shakes hands (DDS Security 1.1, 7.4.3.3).
constexpr std::uint32_t handshakes = 0x000201c3, handshakes_reader = 0x000201c4;

/// The endpoints of discovery that there are beside the encrypted ones. They have nothing to tell,
/// and tell each other so.
bool tells_of_endpoints(std::uint32_t writer) {
  return writer == topics || writer == writers || writer == readers || writer == liveliness;
}

void read_data(Plaintext& said, Bytes part, std::uint8_t kind, std::uint8_t flags) {
  const Numbers numbers{part, (flags & little_endian_flag) != 0};
  if (part.size() < min_data_size) return;
  const std::uint32_t reader = entity_at(part, 4), writer = entity_at(part, 8);
  if (writer == handshakes && (reader == handshakes_reader || reader == 0)) {
    said.shakes_hands = true;
    return;
  }
  if (writer != participants || (reader != participants_reader && reader != 0)) {
    said.out_of_place = true;
    return;
  }
  std::size_t at = 4u + numbers.two(2);
  // An announcement is whole, and says all.
  bool ends = kind != data || !(flags & data_flag) || (flags & key_flag) || at > part.size();
  if (!ends && (flags & parameters_flag)) {
    const auto length = for_each_parameter({part.subspan(at), numbers.little_endian},
                                           [&](std::uint16_t parameter, const Numbers& value) {
                                             ends |= is_end(parameter, value.bytes);
                                           });
    ends |= !length;
    at += length.value_or(0);
  }
  constexpr std::size_t head = 4;
  if (ends || part.size() - at < head) {
    said.departs = true;
    return;
  }
  Plaintext::Announcement made{part.subspan(at), {}};
  for_each_parameter({made.content.subspan(head), (made.content[1] & 1) != 0},
                     [&](std::uint16_t parameter, const Numbers& value) {
                       if (parameter != lease_duration || value.bytes.size() < 8) return;
                       const auto whole = static_cast<std::int32_t>(value.four(0));
                       const Duration lease = std::chrono::seconds(std::max(whole, 0)) +
                                              Duration((value.four(4) * 1'000'000'000ull) >> 32);
                       // Said twice, who knows which counts?
                       made.lease = std::min(made.lease.value_or(lease), lease);
                     });
  said.announcements.push_back(made);
}

}  // namespace

Plaintext read_plaintext(Bytes message) {
  Plaintext said;
  for_each_part(message, [&](std::uint8_t kind, std::uint8_t flags, Bytes part, bool) {
    if (kind == data || kind == data_fragment) {
      read_data(said, part, kind, flags);
    } else if (kind == acknack || kind == heartbeat || kind == gap || kind == nack_fragment ||
               kind == heartbeat_fragment) {
      const std::uint32_t writer = part.size() < 8 ? 0 : entity_at(part, 4);
      said.out_of_place |= !tells_of_endpoints(writer) || kind == gap;
    }
    return true;
  });
  return said;
}

}  // namespace prehend::dds
