#include "common/dds/packet.hpp"

#include <algorithm>

#include "common/dds/rtps_parts.hpp"

namespace prehend::dds {
namespace {

using namespace wire;

constexpr std::size_t statistics_size = 56, info_source_size = 20, prefix_in_info_source = 8;
constexpr std::size_t guid_size = 16, locator_size = 24, ip_in_locator = 20;
constexpr std::uint32_t udp4 = 1, tcp4 = 4;  // kinds of locators
constexpr Duration usual_lease = std::chrono::seconds(100);

/// Reads what discovery tells in one part of a message. False: it is not sound.
class Telling {
 public:
  explicit Telling(Packet& packet) : packet_(packet) {}

  bool read(Bytes part, std::uint8_t kind, std::uint8_t flags) {
    const Numbers numbers{part, (flags & little_endian_flag) != 0};
    if (part.size() < (kind == data ? min_data_size : min_fragment_size)) return false;
    // Fast DDS gives a reader of participants whatever is directed to it.
    const std::uint32_t writer =
        entity_at(part, 4) == participants_reader ? participants : entity_at(part, 8);
    if (writer != participants && writer != topics && writer != writers && writer != readers &&
        writer != liveliness)
      return true;
    std::size_t at = 4u + numbers.two(2);
    if (at > part.size()) return false;
    if (flags & parameters_flag) {
      const auto length =
          for_each_parameter({part.subspan(at), numbers.little_endian},
                             [&](std::uint16_t parameter, const Numbers& value) {
                               if (parameter == key_hash && value.bytes.size() >= guid_size)
                                 is_said_of(value.bytes);
                               ends_ |= is_end(parameter, value.bytes);
                             });
      if (!length) return false;
      at += *length;
    }
    const bool whole = kind == data;
    if (!whole && numbers.four(20) != 1) return true;  // a later fragment names nobody
    if (whole && !(flags & (data_flag | key_flag))) {
      if (writer == participants) announce({}, true);
      return true;
    }
    return read_content(part.subspan(at), writer, whole, (flags & data_flag) != 0);
  }

 private:
  bool read_content(Bytes content, std::uint32_t writer, bool whole, bool says_all) {
    if (content.size() < 4) return false;
    // Fast DDS takes so short a key as it stands.
    if (!says_all && content.size() <= guid_size) {
      if (content.size() == guid_size) is_said_of(content);
      if (writer == participants) announce({}, true);
      return true;
    }
    const bool little_endian = content[1] & 1;
    content = content.subspan(4);
    if (writer == liveliness) {
      if (content.size() < GuidPrefix{}.size()) return false;
      is_said_of(content);
      return true;
    }
    Announcement said;
    said.lease = usual_lease;
    bool named = false;
    const auto length = for_each_parameter(
        {content, little_endian}, [&](std::uint16_t parameter, const Numbers& value) {
          const std::size_t size = value.bytes.size();
          if ((parameter == participant_guid || parameter == endpoint_guid) && size >= guid_size) {
            is_said_of(value.bytes);
            named |= parameter == participant_guid;
          } else if (parameter == lease_duration && size >= 8) {
            const auto whole_seconds = static_cast<std::int32_t>(value.four(0));
            said.lease = std::chrono::seconds(std::max(whole_seconds, 0)) +
                         Duration((value.four(4) * 1'000'000'000ull) >> 32);
          } else if ((parameter == default_locator || parameter == metatraffic_locator) &&
                     size >= locator_size && (value.four(0) == udp4 || value.four(0) == tcp4)) {
            said.addresses.push_back(array_at<4>(value.bytes, ip_in_locator));
          }
        });
    if (!length && whole) return false;
    if (writer != participants) return true;
    // An announcement that does not say whose it is could be taken for anybody's.
    if (says_all && !named) return false;
    announce(std::move(said), !says_all || ends_);
    return true;
  }

  void is_said_of(Bytes guid) {
    subject_ = array_at<12>(guid, 0);
    packet_.for_others |= subject_ != packet_.sender;
  }
  void announce(Announcement said, bool leaves) {
    said.participant = subject_.value_or(packet_.sender);
    said.leaves = leaves;
    packet_.announcements.push_back(std::move(said));
  }

  Packet& packet_;
  std::optional<GuidPrefix> subject_;
  bool ends_ = false;
};

}  // namespace

std::optional<Packet> read_packet(Bytes message) {
  if (message.size() < header_size) return std::nullopt;
  Packet packet;
  packet.sender = array_at<12>(message, 8);
  const bool sound =
      for_each_part(message, [&](std::uint8_t kind, std::uint8_t flags, Bytes part, bool is_last) {
        if (kind == statistics) return part.size() == statistics_size && is_last;
        if (kind == info_source) {
          if (part.size() != info_source_size) return false;
          packet.for_others |= array_at<12>(part, prefix_in_info_source) != packet.sender;
        }
        return (kind != data && kind != data_fragment) || Telling(packet).read(part, kind, flags);
      });
  if (!sound) return std::nullopt;
  return packet;
}

bool is_server(const GuidPrefix& prefix) {
  GuidPrefix pattern = first_server;
  pattern[2] = prefix[2];
  return prefix == pattern;
}

}  // namespace prehend::dds
