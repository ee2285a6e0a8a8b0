#include "tests/support/packets/packets.hpp"

#include <algorithm>

namespace prehend::test {
namespace {

constexpr std::uint8_t info_timestamp = 0x09, info_source = 0x0c, data_kind = 0x15;
constexpr std::uint8_t parameters_flag = 0x02, key_flag = 0x08;
constexpr std::uint32_t writers = 0x000003c2, liveliness_writer = 0x000200c2, a_user = 0x00000103;

void append(Bytes& to, std::span<const std::uint8_t> more) {
  for (const std::uint8_t byte : more) to.push_back(byte);
}

void entity(Bytes& to, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8)
    to.push_back(static_cast<std::uint8_t>(value >> shift));
}

}  // namespace

Bytes guid(const dds::GuidPrefix& prefix, std::uint32_t of) {
  Bytes bytes(prefix.begin(), prefix.end());
  entity(bytes, of);
  return bytes;
}

dds::GuidPrefix participant(std::uint8_t n) {
  return {1, 15, n, 2, 3, 4, 5, 6, 7, 8, 9, n};
}

Message::Message(const dds::GuidPrefix& sender, bool little_endian)
    : little_endian_(little_endian), bytes_(20) {
  const Bytes head{'R', 'T', 'P', 'S', 2, 3, 1, 15};
  std::copy(head.begin(), head.end(), bytes_.begin());
  std::copy(sender.begin(), sender.end(), bytes_.begin() + 8);
}

void Message::two(Bytes& to, std::uint32_t value) const {
  const auto low = static_cast<std::uint8_t>(value), high = static_cast<std::uint8_t>(value >> 8);
  to.push_back(little_endian_ ? low : high);
  to.push_back(little_endian_ ? high : low);
}

void Message::four(Bytes& to, std::uint32_t value) const {
  two(to, little_endian_ ? value & 0xffff : value >> 16);
  two(to, little_endian_ ? value >> 16 : value & 0xffff);
}

void Message::parameter(Bytes& to, std::uint16_t id, const Bytes& value) const {
  two(to, id);
  two(to, static_cast<std::uint32_t>(value.size()));
  append(to, value);
}

Message& Message::part(std::uint8_t kind, const Bytes& content, std::uint8_t flags) {
  bytes_.push_back(kind);
  bytes_.push_back(static_cast<std::uint8_t>(flags | (little_endian_ ? 1 : 0)));
  two(bytes_, static_cast<std::uint32_t>(content.size()));
  append(bytes_, content);
  return *this;
}

Message& Message::timestamp() {
  return part(info_timestamp, Bytes(8));
}

Message& Message::source(const dds::GuidPrefix& sender) {
  Bytes content(8 + sender.size());
  content[4] = 2;
  content[5] = 3;
  std::copy(sender.begin(), sender.end(), content.begin() + 8);
  return part(info_source, content);
}

Bytes Message::list_head() const {
  return {0, static_cast<std::uint8_t>(little_endian_ ? 3 : 2), 0, 0};
}

Bytes Message::locator(const dds::Ipv4& address) const {
  Bytes bytes;
  four(bytes, 1);
  four(bytes, 7411);
  bytes.resize(bytes.size() + 12);
  bytes.insert(bytes.end(), address.begin(), address.end());
  return bytes;
}

Bytes Message::lease(Duration lease) const {
  Bytes bytes;
  four(bytes, static_cast<std::uint32_t>(lease / std::chrono::seconds(1)));
  four(bytes, static_cast<std::uint32_t>((lease % std::chrono::seconds(1)).count() *
                                         0x1'0000'0000ll / 1'000'000'000));
  return bytes;
}

Bytes Message::list(const std::vector<Parameter>& parameters) const {
  Bytes bytes;
  for (const auto& [id, value] : parameters) parameter(bytes, id, value);
  parameter(bytes, 0x0001, {});
  return bytes;
}

Message& Message::data(const Data& data) {
  Bytes bytes;
  two(bytes, 0);
  two(bytes, data.fragment ? 28 : 16);  // to what follows the number of the sample
  entity(bytes, data.reader);
  entity(bytes, data.writer);
  four(bytes, 0);
  four(bytes, data.sequence);
  if (data.fragment) {
    four(bytes, 1);  // the first
    two(bytes, 1);   // of one
    two(bytes, static_cast<std::uint32_t>(data.content.size()));
    four(bytes, static_cast<std::uint32_t>(data.content.size()));
  }
  append(bytes, data.parameters);
  append(bytes, data.content);
  // A fragment has its key flag elsewhere, and no flag for data.
  const int flag = data.fragment ? (data.content_flag == key_flag ? 0x04 : 0) : data.content_flag;
  return part(data.fragment ? 0x16 : data_kind, bytes,
              static_cast<std::uint8_t>(flag | (data.parameters.empty() ? 0 : parameters_flag)));
}

Message& Message::samples(std::uint8_t kind, std::uint32_t writer, std::uint32_t first,
                          std::uint32_t last) {
  Bytes bytes;
  entity(bytes, 0);
  entity(bytes, writer);
  four(bytes, 0);
  four(bytes, first);
  four(bytes, 0);
  four(bytes, last);
  four(bytes, kind == 7 ? last : 0);  // a heartbeat's count; the length of a gap's further set
  return part(kind, bytes);
}

Bytes Message::text(std::string_view text) const {
  Bytes bytes;
  four(bytes, static_cast<std::uint32_t>(text.size() + 1));
  bytes.insert(bytes.end(), text.begin(), text.end());
  bytes.resize((bytes.size() / 4 + 1) * 4);  // ends with a zero, and a multiple of four
  return bytes;
}

Bytes Message::token(std::string_view authority) const {
  Bytes bytes = text("DDS:Auth:PKI-DH:1.0");
  four(bytes, 2);
  for (const std::string_view word :
       {std::string_view("dds.cert.sn"), std::string_view("/CN=somebody"),
        std::string_view("dds.ca.sn"), authority})
    append(bytes, text(word));
  four(bytes, 0);
  return bytes;
}

Message& Message::announcement(const dds::GuidPrefix& participant,
                               const std::vector<dds::Ipv4>& addresses, Duration lease,
                               const std::vector<std::pair<std::uint16_t, Bytes>>& more) {
  Bytes content = list_head();
  parameter(content, 0x0015, {2, 3, 0, 0});  // the protocol's version
  parameter(content, 0x0050, guid(participant));
  for (const dds::Ipv4& address : addresses) parameter(content, 0x0031, locator(address));
  parameter(content, 0x0002, this->lease(lease));
  for (const auto& [id, value] : more) parameter(content, id, value);
  parameter(content, 0x0001, {});
  return data({.content = content});
}

Message& Message::departure(const dds::GuidPrefix& participant) {
  Bytes content = list_head();
  append(content, list({{0x0050, guid(participant)}}));
  // Disposed, unregistered.
  return data({.parameters = list({{0x0070, guid(participant)}, {0x0071, {0, 0, 0, 3}}}),
               .content = content,
               .content_flag = key_flag});
}

Message& Message::endpoint(const dds::GuidPrefix& participant) {
  Bytes content = list_head();
  parameter(content, 0x005a, guid(participant, a_user));
  parameter(content, 0x0005, {4, 0, 0, 0, 'a', 'b', 'c', 0});  // the topic's name
  parameter(content, 0x0001, {});
  return data({.writer = writers, .content = content});
}

Message& Message::liveliness(const dds::GuidPrefix& participant) {
  Bytes content(4 + participant.size() + 8);
  content[1] = little_endian_ ? 1 : 0;
  std::copy(participant.begin(), participant.end(), content.begin() + 4);
  return data({.writer = liveliness_writer, .content = content});
}

Message& Message::sample(std::size_t size) {
  Bytes content(4 + size, 0x3f);
  content[0] = content[2] = content[3] = 0;
  content[1] = 1;
  return data({.writer = a_user, .content = content});
}

}  // namespace prehend::test
