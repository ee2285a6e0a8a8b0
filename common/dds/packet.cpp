#include "common/dds/packet.hpp"

#include <algorithm>

#include "common/dds/rtps_parts.hpp"
#include "common/dds/user_data.hpp"

namespace prehend::dds {
namespace {

using namespace wire;

constexpr std::size_t statistics_size = 56, info_source_size = 20, prefix_in_info_source = 8;
constexpr std::size_t guid_size = 16, locator_size = 24, ip_in_locator = 20;
constexpr std::uint32_t udp4 = 1, tcp4 = 4;  // kinds of locators
constexpr Duration usual_lease = std::chrono::seconds(100);

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
  } else if (parameter == participant_user_data) {
    if (UserData told = read_user_data(text_at(value, at, 40)); !told.middleware.empty()) {
      said.middleware = std::move(told.middleware);
      said.role = told.role;
    }
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
      if (property == "dds.cert.sn") said.certificate = std::move(content);
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
          } else if (writer == participants) {
            read_word(said, parameter, value);
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
