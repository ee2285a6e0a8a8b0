#include "services/robot/core/inspire_protocol.hpp"

#include <algorithm>
#include <utility>

namespace prehend::robot::inspire {
namespace {

constexpr std::size_t before_body = 4;  // header, id and length
constexpr std::size_t min_body = 4;     // command, address, and something
constexpr std::size_t max_body = 96;

std::string_view header_of(Side side) {
  return side == Side::asks ? "\xeb\x90" : "\x90\xeb";
}

std::uint8_t byte_at(std::string_view bytes, std::size_t i) {
  return static_cast<std::uint8_t>(bytes[i]);
}

char sum_of(std::string_view bytes) {
  unsigned sum = 0;
  for (const char c : bytes) sum += static_cast<std::uint8_t>(c);
  return static_cast<char>(sum & 0xff);
}

}  // namespace

std::string encode(Side side, const Frame& frame) {
  std::string body{static_cast<char>(frame.id), static_cast<char>(frame.data.size() + 3),
                   static_cast<char>(frame.command), static_cast<char>(frame.address & 0xff),
                   static_cast<char>(frame.address >> 8)};
  body += frame.data;
  return std::string(header_of(side)) + body + sum_of(body);
}

/// Everything before a header is skipped, but for what may be the begin of one.
bool Parser::find_header() {
  const std::string_view header = header_of(side_);
  const std::size_t at = bytes_.find(header);
  if (at != std::string::npos) {
    bytes_.erase(0, at);
    return true;
  }
  const bool half = !bytes_.empty() && bytes_.back() == header[0];
  bytes_.erase(0, bytes_.size() - (half ? 1 : 0));
  return false;
}

std::optional<Frame> Parser::next() {
  while (find_header()) {
    if (bytes_.size() < before_body) return std::nullopt;
    const std::size_t length = byte_at(bytes_, 3), whole = before_body + length + 1;
    if (length >= min_body && length <= max_body) {
      if (bytes_.size() < whole) return std::nullopt;
      const std::string_view summed = std::string_view(bytes_).substr(2, whole - 3);
      if (sum_of(summed) == bytes_[whole - 1]) {
        Frame found{byte_at(summed, 0), static_cast<Command>(summed[2]),
                    static_cast<std::uint16_t>(byte_at(summed, 3) | byte_at(summed, 4) << 8),
                    std::string(summed.substr(5))};
        bytes_.erase(0, whole);
        return found;
      }
    }
    ++broken_;
    bytes_.erase(0, 1);
  }
  return std::nullopt;
}

int Parser::take_broken() {
  return std::exchange(broken_, 0);
}

std::string bytes_of(const Block& block, const Values& values) {
  std::string bytes;
  for (const int value : values)
    for (int i = 0; i < block.size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
  return bytes;
}

std::optional<Values> values_of(const Block& block, std::string_view bytes) {
  if (bytes.size() != block.bytes()) return std::nullopt;
  Values values{};
  for (std::size_t i = 0; i < motors; ++i)
    values[i] =
        block.size == 1
            ? byte_at(bytes, i)
            : static_cast<std::int16_t>(byte_at(bytes, 2 * i) | byte_at(bytes, 2 * i + 1) << 8);
  return values;
}

std::string explain_error(int bits) {
  static constexpr std::array texts{"has stalled", "is too hot", "overcurrent", "is broken",
                                    "is not heard by the hand"};
  std::string text;
  for (std::size_t i = 0; i < 8; ++i)
    if ((bits & 1 << i) != 0)
      text += (text.empty() ? "" : ", ") +
              (i < texts.size() ? std::string(texts[i]) : "error " + std::to_string(1 << i));
  return text;
}

double dof_of(const model::HandDof& dof, double count) {
  return dof.upper - (dof.upper - dof.lower) * count / open_count;
}

double count_of(const model::HandDof& dof, double value) {
  return std::clamp(open_count * (dof.upper - value) / (dof.upper - dof.lower), 0.0,
                    0.0 + open_count);
}

Expected<void> check_hand(const model::HandModel& hand) {
  bool fits = hand.dofs().size() == motors;
  std::string names;
  for (std::size_t i = 0; i < motors; ++i) {
    fits = fits && hand.dofs()[i].name == dof_names[i];
    names += (names.empty() ? "" : ", ") + std::string(dof_names[i]);
  }
  if (fits) return {};
  return wrong_use("an Inspire hand has the DoFs " + names, hand.name(), "give inspire_rh56");
}

}  // namespace prehend::robot::inspire
