#include "bird_emulator.hpp"

#include <algorithm>

namespace prehend::glove::bird {
namespace {

constexpr Duration reset_time = std::chrono::milliseconds(200);
constexpr Duration configure_time = std::chrono::milliseconds(300);
constexpr char xon = 0x11, xoff = 0x13;

/// Bytes of the command that begins with `first`, if its length does not depend on what follows.
std::size_t command_length(char first) {
  switch (first) {
    case 'L':
      return 3;
    case 'M':
    case 'O':
      return 2;
    default:
      return 1;
  }
}

}  // namespace

Emulator::Emulator(int units, const Faults& faults)
    : units_(std::clamp(units, 1, static_cast<int>(sites_by_address().size()))),
      faults_(faults),
      random_(faults.seed) {
  reset();
}

void Emulator::reset() {
  layout_ = Layout{.format = Format::position_angles};
  unit_format_.assign(static_cast<std::size_t>(units_), layout_.format);
  running_units_ = 1;
  addressed_ = 1;
  streaming_ = paused_ = false;
  report_every_ = 1;
  pending_.clear();
}

std::string Emulator::receive(std::string_view bytes, Duration now) {
  now_ = now;
  std::string answer;
  for (const char byte : bytes) {
    if (now_ < busy_until_) continue;
    if (pending_.empty() && (byte == xon || byte == xoff)) {
      paused_ = byte == xoff;
      continue;
    }
    if (pending_.empty() && static_cast<std::uint8_t>(byte) >= 0xF0u) {
      addressed_ = static_cast<std::uint8_t>(byte) & 0x0f;
      continue;
    }
    pending_.push_back(byte);
    std::size_t length = command_length(pending_[0]);
    if (pending_[0] == 'P') {
      if (pending_.size() < 2) continue;
      length = 2 + changed_length(static_cast<std::uint8_t>(pending_[1]));
    }
    if (pending_.size() < length) continue;
    const std::string complete = std::move(pending_);
    pending_.clear();
    answer += command(complete);
    addressed_ = 1;
  }
  return answer;
}

std::string Emulator::command(std::string_view bytes) {
  if (const auto format = format_of_command(bytes[0])) {
    if (addressed_ >= 1 && addressed_ <= units_)
      unit_format_[static_cast<std::size_t>(addressed_ - 1)] = *format;
    return {};
  }
  switch (bytes[0]) {
    case 'B':
      streaming_ = false;
      return records();
    case '@':
      streaming_ = true;
      break;
    case 'G':
      streaming_ = false;
      break;
    case 'Q':
      report_every_ = 1;
      break;
    case 'R':
      report_every_ = 2;
      break;
    case 'S':
      report_every_ = 8;
      break;
    case 'T':
      report_every_ = 32;
      break;
    case 'M':
      layout_.button = bytes[1] != 0;
      break;
    case 'O':
      return examine(static_cast<std::uint8_t>(bytes[1]));
    case 'P':
      change(static_cast<std::uint8_t>(bytes[1]), bytes.substr(2));
      break;
    case '/':
      reset();
      busy_until_ = now_ + reset_time;
      break;
    default:
      break;  // F and L change nothing that shows; the rest is ignored, as a tracker does
  }
  return {};
}

std::string Emulator::examine(std::uint8_t parameter) const {
  using std::string_literals::operator""s;
  switch (parameter) {
    case status:
      return "\x08\xD1"s;
    case revision:
      return "\x03\x3C"s;
    case position_scaling:
      return layout_.range == long_range ? "\x01\x00"s : "\x00\x00"s;
    case error_code:
      return "\x00"s;
    case model_name:
      return "6DFOB     "s;
    case group_mode:
      return layout_.group ? "\x01"s : "\x00"s;
    case system_status: {
      std::string units(most_units, '\0');
      for (int unit = 0; unit < units_; ++unit)
        units[static_cast<std::size_t>(unit)] = static_cast<char>(
            accessible | has_receiver | (unit < running_units_ ? running : std::uint8_t{0}));
      return units;
    }
    default:
      return {};
  }
}

void Emulator::change(std::uint8_t parameter, std::string_view value) {
  switch (parameter) {
    case position_scaling:
      layout_.range = value[0] != 0 ? long_range : short_range;
      break;
    case group_mode:
      layout_.group = value[0] != 0;
      break;
    case auto_configure:
      running_units_ = std::clamp<int>(value[0], 1, units_);
      busy_until_ = now_ + configure_time;
      break;
    default:
      break;
  }
}

std::string Emulator::measure(const Frame& frame, Duration now) {
  now_ = now;
  readings_ = frame.readings;
  const bool due = measurements_++ % static_cast<std::uint64_t>(report_every_) == 0;
  if (!streaming() || !due || now_ < busy_until_) return {};
  return records();
}

std::string Emulator::records() {
  std::string bytes;
  const int count = layout_.group ? running_units_ : 1;
  for (int unit = 0; unit < count; ++unit) {
    Reading reading;  // a sensor that the source does not have lies at the transmitter
    for (const Reading& known : readings_)
      if (known.site == sites_by_address()[static_cast<std::size_t>(unit)]) reading = known;
    Layout layout = layout_;
    layout.format = unit_format_[static_cast<std::size_t>(unit)];
    std::string record =
        encode(reading.p_TS, reading.q_TS.normalized().toRotationMatrix(), layout, unit + 1);
    if (random_.uniform() < faults_.drop_bytes) record.erase(random_.index(record.size()), 1);
    if (random_.uniform() < faults_.garbage)
      for (std::size_t n = 1 + random_.index(20); n > 0; --n)
        bytes.push_back(static_cast<char>(random_.bits() & 0xff));
    bytes += record;
  }
  return bytes;
}

}  // namespace prehend::glove::bird
