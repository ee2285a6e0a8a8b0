#include "common/dds/packet.hpp"

#include <algorithm>
#include <string_view>

namespace prehend::dds {
namespace {

using Bytes = std::span<const std::uint8_t>;

// Kinds of parts (DDSI-RTPS 2.3, 9.4.5.1.1).
constexpr std::uint8_t pad = 0x01, info_timestamp = 0x09;  // may say a length of 0 and mean it
constexpr std::uint8_t info_source = 0x0c, data = 0x15, data_fragment = 0x16;
constexpr std::uint8_t first_secured = 0x30, last_secured = 0x34;  // DDS Security 1.1, 7.3.6
constexpr std::uint8_t statistics = 0x80;                          // of Fast DDS

constexpr std::size_t header_size = 20, part_header_size = 4, statistics_size = 56;
constexpr std::size_t info_source_size = 20, prefix_in_info_source = 8;
constexpr std::size_t min_data_size = 20, min_fragment_size = 32;

// Flags of data.
constexpr std::uint8_t little_endian_flag = 0x01, parameters_flag = 0x02, data_flag = 0x04,
                       key_flag = 0x08;
// Who writes what discovery tells (9.3.1.5), in the order of the bytes.
constexpr std::uint32_t participants = 0x000100c2, topics = 0x000002c2, writers = 0x000003c2,
                        readers = 0x000004c2, liveliness = 0x000200c2;
// Parameters (9.6.3.2).
constexpr std::uint16_t end_of_list = 0x0001, lease_duration = 0x0002, default_locator = 0x0031,
                        metatraffic_locator = 0x0032, participant_guid = 0x0050,
                        endpoint_guid = 0x005a, key_hash = 0x0070, entity_name = 0x0062,
                        user_data = 0x002c, identity_token = 0x1001, product_version = 0x8000;
constexpr std::size_t guid_size = 16, locator_size = 24, ip_in_locator = 20;
constexpr std::uint32_t udp4 = 1, tcp4 = 4;  // kinds of locators
constexpr Duration usual_lease = std::chrono::seconds(100);

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

/// A string with its length before it, as far as it lies within and is printable; at moves past it.
std::string text_at(const Numbers& value, std::size_t& at, std::size_t max_size = 255) {
  if (at + 4 > value.bytes.size()) return {};
  const std::size_t length = value.four(at);
  at += 4;
  if (length > value.bytes.size() - at) {
    at = value.bytes.size();
    return {};
  }
  std::string text;
  for (const std::uint8_t byte : value.bytes.subspan(at, length))
    if (byte >= ' ' && byte <= '~' && text.size() < max_size) text += static_cast<char>(byte);
  at += (length + 3) / 4 * 4;
  return text;
}

/// What an announcement says of its participant for people to read.
void read_word(Announcement& said, std::uint16_t parameter, const Numbers& value) {
  std::size_t at = 0;
  if (parameter == entity_name) {
    said.name = text_at(value, at);
  } else if (parameter == user_data) {
    if (std::string text = text_at(value, at, 40); text.starts_with("Fast DDS "))
      said.middleware = std::move(text);
  } else if (parameter == product_version && value.bytes.size() >= 4) {
    if (said.middleware.empty())
      for (std::size_t i = 0; i < 3; ++i)
        said.middleware += (i == 0 ? "Fast DDS " : ".") + std::to_string(value.bytes[i]);
  } else if (parameter == identity_token) {  // DDS Security 1.1, 7.2.1: a class, then properties
    said.secured = true;
    text_at(value, at);
    if (at + 4 > value.bytes.size()) return;
    std::uint32_t left = value.four(at);
    at += 4;
    for (; left > 0 && at < value.bytes.size(); --left) {
      const std::string property = text_at(value, at);
      std::string content = text_at(value, at);
      if (property == "dds.ca.sn") said.authority = std::move(content);
    }
  }
}

/// Reads what discovery tells in one part of a message. False: it is not sound.
class Telling {
 public:
  explicit Telling(Packet& packet) : packet_(packet) {}

  bool read(Bytes part, std::uint8_t kind, std::uint8_t flags) {
    const Numbers numbers{part, (flags & little_endian_flag) != 0};
    if (part.size() < (kind == data ? min_data_size : min_fragment_size)) return false;
    // Entities are not numbers: their bytes do not change places.
    const std::uint32_t writer = Numbers{part, false}.four(8);
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
          } else if (writer == participants) {
            read_word(said, parameter, value);
          }
        });
    if (!length && whole) return false;
    if (writer != participants) return true;
    // An announcement that does not say whose it is could be taken for anybody's.
    if (says_all && !named) return false;
    announce(std::move(said), !says_all);
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
};

}  // namespace

std::optional<Packet> read_packet(Bytes message) {
  constexpr std::string_view name = "RTPS";
  if (message.size() < header_size || !std::equal(name.begin(), name.end(), message.begin()))
    return std::nullopt;
  Packet packet;
  packet.sender = array_at<12>(message, 8);
  for (std::size_t at = header_size; at < message.size();) {
    if (message.size() - at < part_header_size) return std::nullopt;
    const std::uint8_t kind = message[at], flags = message[at + 1];
    std::size_t length = Numbers{message.subspan(at), (flags & little_endian_flag) != 0}.two(2);
    at += part_header_size;
    const std::size_t left = message.size() - at;
    // The last part may leave its length to the message's.
    if (length == 0 && kind != pad && kind != info_timestamp) length = left;
    if (length > left) return std::nullopt;
    const Bytes part = message.subspan(at, length);
    if (kind == statistics && (length != statistics_size || length != left)) return std::nullopt;
    if (kind == info_source) {
      if (length != info_source_size) return std::nullopt;
      packet.for_others |= array_at<12>(part, prefix_in_info_source) != packet.sender;
    }
    if ((kind == data || kind == data_fragment) && !Telling(packet).read(part, kind, flags))
      return std::nullopt;
    // Parts begin at multiples of four, those within a secured message where the last one ends.
    if (kind < first_secured || kind > last_secured) length = std::min((length + 3) / 4 * 4, left);
    at += length;
  }
  return packet;
}

bool is_server(const GuidPrefix& prefix) {
  GuidPrefix pattern = first_server;
  pattern[2] = prefix[2];
  return prefix == pattern;
}

}  // namespace prehend::dds
