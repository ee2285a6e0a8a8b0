#include "services/robot/core/modbus_rtu.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace prehend::robot::modbus {
namespace {

constexpr std::size_t crc_size = 2, head = 2;  // id and function
constexpr std::size_t max_frame = 256;
constexpr std::uint8_t illegal_function = 1, illegal_address = 2, illegal_value = 3;

std::uint8_t byte_at(std::string_view bytes, std::size_t i) {
  return static_cast<std::uint8_t>(bytes[i]);
}

/// Of the frame that begins here, with its CRC; nothing: more bytes are needed; 0: there is none.
std::optional<std::size_t> length_of(std::string_view bytes, Side side) {
  if (bytes.size() < head) return std::nullopt;
  const std::uint8_t function = byte_at(bytes, 1);
  const auto counted = [&](std::size_t at) -> std::optional<std::size_t> {
    if (bytes.size() <= at) return std::nullopt;
    return at + 1 + byte_at(bytes, at) + crc_size;
  };
  const bool asks = side == Side::asks;
  switch (static_cast<Function>(function)) {
    case Function::read_holding:
    case Function::read_input:
      return asks ? 8 : counted(2);
    case Function::write:
      return asks ? counted(6) : 8;
    case Function::write_and_read:
      return asks ? counted(10) : counted(2);
  }
  return !asks && (function & refused) != 0 ? std::size_t{5} : std::size_t{0};
}

Frame refuse(const Frame& question, std::uint8_t code) {
  return {question.id, static_cast<std::uint8_t>(question.function | refused),
          std::string(1, static_cast<char>(code))};
}

std::optional<Registers> part(const Registers& all, std::uint16_t from, std::uint16_t address,
                              std::uint16_t count) {
  if (address < from || address + count > from + all.size() || count == 0) return std::nullopt;
  const auto first = all.begin() + (address - from);
  return Registers(first, first + count);
}

/// 0: done; else why not.
std::uint8_t take(std::string_view data, std::size_t counts_at, Map& map) {
  const std::uint16_t address = word(data, counts_at - 4), count = word(data, counts_at - 2);
  const std::string_view values = data.substr(counts_at + 1);
  if (byte_at(data, counts_at) != 2 * count || values.size() != 2u * count) return illegal_value;
  if (!part(map.written, map.written_at, address, count)) return illegal_address;
  for (std::size_t i = 0; i < count; ++i)
    map.written[address - map.written_at + i] = word(values, 2 * i);
  return 0;
}

}  // namespace

std::uint16_t crc(std::string_view bytes) {
  unsigned sum = 0xffff;
  for (const char c : bytes) {
    sum ^= static_cast<std::uint8_t>(c);
    for (int bit = 0; bit < 8; ++bit) sum = (sum & 1u) != 0 ? sum >> 1 ^ 0xa001u : sum >> 1;
  }
  return static_cast<std::uint16_t>(sum);
}

std::string encode(const Frame& frame) {
  std::string bytes{static_cast<char>(frame.id), static_cast<char>(frame.function)};
  bytes += frame.data;
  const std::uint16_t sum = crc(bytes);
  bytes += static_cast<char>(sum & 0xff);
  bytes += static_cast<char>(sum >> 8);
  return bytes;
}

Frame read(std::uint8_t id, Function function, std::uint16_t address, std::uint16_t count) {
  return {id, static_cast<std::uint8_t>(function), words({address, count})};
}

Frame write(std::uint8_t id, std::uint16_t address, const Registers& values) {
  const auto count = static_cast<std::uint16_t>(values.size());
  return {id, static_cast<std::uint8_t>(Function::write),
          words({address, count}) + static_cast<char>(2 * count) + words(values)};
}

std::optional<Frame> Parser::next() {
  while (!bytes_.empty()) {
    const auto length = length_of(bytes_, side_);
    if (!length || (*length > bytes_.size() && *length <= max_frame)) return std::nullopt;
    if (*length >= head + crc_size && *length <= max_frame) {
      const std::string_view all = std::string_view(bytes_).substr(0, *length);
      const std::string_view body = all.substr(0, *length - crc_size);
      const unsigned sum = byte_at(all, *length - 2) | unsigned{byte_at(all, *length - 1)} << 8;
      if (sum == crc(body)) {
        Frame found{byte_at(body, 0), byte_at(body, 1), std::string(body.substr(head))};
        bytes_.erase(0, *length);
        in_damage_ = false;
        return found;
      }
    }
    bytes_.erase(0, 1);
    if (!std::exchange(in_damage_, true)) ++broken_;
  }
  in_damage_ = false;
  return std::nullopt;
}

int Parser::take_broken() {
  return std::exchange(broken_, 0);
}

std::string explain_refusal(std::uint8_t code) {
  static constexpr std::array texts{"no error",      "illegal function", "illegal address",
                                    "illegal value", "device failure",   "acknowledged",
                                    "device is busy"};
  return code < texts.size() ? texts[code] : "error " + std::to_string(code);
}

std::uint16_t word(std::string_view bytes, std::size_t at) {
  return static_cast<std::uint16_t>(byte_at(bytes, at) << 8 | byte_at(bytes, at + 1));
}

std::string words(const Registers& values) {
  std::string bytes;
  for (const std::uint16_t value : values) {
    bytes += static_cast<char>(value >> 8);
    bytes += static_cast<char>(value & 0xff);
  }
  return bytes;
}

std::optional<Registers> registers_of(const Frame& answer, std::size_t count) {
  if (answer.data.size() != 1 + 2 * count || byte_at(answer.data, 0) != 2 * count)
    return std::nullopt;
  Registers values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(word(answer.data, 1 + 2 * i));
  return values;
}

std::optional<Frame> answer(const Frame& question, std::uint8_t id, Map& map) {
  if (question.id != id) return std::nullopt;
  const std::string_view data = question.data;
  const auto function = static_cast<Function>(question.function);
  const bool writes = function == Function::write || function == Function::write_and_read;
  const bool reads = function != Function::write;
  if (!writes && function != Function::read_holding && function != Function::read_input)
    return refuse(question, illegal_function);
  const std::size_t counts_at = function == Function::write ? 4 : 8;
  if (data.size() < (writes ? counts_at + 1 : 4)) return refuse(question, illegal_value);
  // What is written counts for what is then read.
  if (writes)
    if (const std::uint8_t why = take(data, counts_at, map); why != 0) return refuse(question, why);
  if (!reads) return Frame{id, question.function, std::string(data.substr(0, 4))};
  const auto values = part(map.status, map.status_at, word(data, 0), word(data, 2));
  if (!values) return refuse(question, illegal_address);
  return Frame{id, question.function, static_cast<char>(2 * values->size()) + words(*values)};
}

}  // namespace prehend::robot::modbus
