#include "services/robot/core/dynamixel_protocol.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace prehend::robot::dynamixel {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view header = "\xff\xff\xfd\x00"sv;
constexpr std::string_view stuffed = "\xff\xff\xfd"sv;  // within a packet, another FD follows
constexpr std::size_t before_body = 7;                  // header, id and length
constexpr std::size_t crc_size = 2;
constexpr std::size_t longest = 2048;  // of what the length counts

std::uint8_t byte_at(std::string_view bytes, std::size_t i) {
  return static_cast<std::uint8_t>(bytes[i]);
}

/// Whether the three bytes before the place are those of a header.
bool like_header(std::string_view bytes, std::size_t end) {
  return end >= stuffed.size() && bytes.substr(end - stuffed.size(), stuffed.size()) == stuffed;
}

std::string stuff(std::string_view body) {
  std::string out;
  for (std::size_t i = 0; i < body.size(); ++i) {
    out += body[i];
    if (like_header(body, i + 1)) out += '\xfd';
  }
  return out;
}

std::string unstuff(std::string_view body) {
  std::string out;
  for (std::size_t i = 0; i < body.size(); ++i)
    if (!(like_header(body, i) && body[i] == '\xfd')) out += body[i];
  return out;
}

constexpr std::array<std::uint16_t, 256> crc_table = [] {
  std::array<std::uint16_t, 256> made{};
  for (unsigned i = 0; i < made.size(); ++i) {
    unsigned sum = i << 8;
    for (int bit = 0; bit < 8; ++bit) sum = (sum & 0x8000u) != 0 ? sum << 1 ^ 0x8005u : sum << 1;
    made[i] = static_cast<std::uint16_t>(sum);
  }
  return made;
}();

}  // namespace

std::uint16_t crc(std::string_view bytes) {
  unsigned sum = 0;
  for (const char c : bytes)
    sum = (sum << 8 ^ crc_table[(sum >> 8 ^ static_cast<std::uint8_t>(c)) & 0xffu]) & 0xffffu;
  return static_cast<std::uint16_t>(sum);
}

std::string encode(const Packet& packet) {
  const std::string body = stuff(static_cast<char>(packet.instruction) + packet.parameters);
  std::string bytes(header);
  bytes += static_cast<char>(packet.id);
  bytes += little_endian(static_cast<std::int64_t>(body.size() + crc_size), 2);
  bytes += body;
  return bytes + little_endian(crc(bytes), crc_size);
}

void Parser::feed(std::string_view bytes) {
  bytes_.append(bytes);
}

/// Everything before a header is skipped, but for what may be the begin of one.
bool Parser::find_header() {
  const std::size_t at = bytes_.find(header);
  if (at != std::string::npos) {
    bytes_.erase(0, at);
    return true;
  }
  std::size_t keep = std::min(header.size() - 1, bytes_.size());
  while (keep > 0 && !bytes_.ends_with(header.substr(0, keep))) --keep;
  bytes_.erase(0, bytes_.size() - keep);
  return false;
}

std::optional<Packet> Parser::next() {
  while (find_header()) {
    if (bytes_.size() < before_body) return std::nullopt;
    const std::size_t length = byte_at(bytes_, 5) | std::size_t{byte_at(bytes_, 6)} << 8;
    const std::size_t whole = before_body + length;
    if (length > crc_size && length <= longest) {
      if (bytes_.size() < whole) return std::nullopt;
      const std::string_view packet(bytes_.data(), whole);
      const unsigned sum = byte_at(packet, whole - 2) | unsigned{byte_at(packet, whole - 1)} << 8;
      if (sum == crc(packet.substr(0, whole - crc_size))) {
        std::string body = unstuff(packet.substr(before_body, length - crc_size));
        Packet found{byte_at(packet, 4), static_cast<Instruction>(body[0]), body.substr(1)};
        bytes_.erase(0, whole);
        return found;
      }
    }
    ++broken_;
    bytes_.erase(0, 1);  // a whole packet may begin within the broken one
  }
  return std::nullopt;
}

int Parser::take_broken() {
  return std::exchange(broken_, 0);
}

std::string explain_refusal(std::uint8_t error) {
  static constexpr std::array texts{"no error",         "result fail",      "instruction error",
                                    "CRC error",        "data range error", "data length error",
                                    "data limit error", "access error"};
  const std::size_t number = error & ~unsigned{alert};
  return number < texts.size() ? texts[number] : "error " + std::to_string(number);
}

std::string explain_hardware(std::uint8_t bits) {
  static constexpr std::array texts{"input voltage", "motor hall sensor", "overheated",
                                    "motor encoder", "electrical shock",  "overload",
                                    "error 64",      "error 128"};
  std::string text;
  for (std::size_t i = 0; i < texts.size(); ++i)
    if ((bits & 1u << i) != 0) text += (text.empty() ? "" : ", ") + std::string(texts[i]);
  return text.empty() ? "no hardware error" : text;
}

std::string little_endian(std::int64_t value, std::size_t size) {
  std::string bytes;
  for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
  return bytes;
}

std::int32_t number(std::string_view bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | byte_at(bytes, i);
  if (bytes.size() == 1) return static_cast<std::uint8_t>(value);
  if (bytes.size() == 2) return static_cast<std::int16_t>(value);
  return static_cast<std::int32_t>(value);
}

std::string read_of(const Item& item) {
  return little_endian(item.address, 2) + little_endian(item.size, 2);
}

std::string write_of(const Item& item, std::int64_t value) {
  return little_endian(item.address, 2) + little_endian(value, item.size);
}

}  // namespace prehend::robot::dynamixel
