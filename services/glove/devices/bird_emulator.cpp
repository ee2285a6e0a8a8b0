#include "services/glove/devices/bird_emulator.hpp"

#include <algorithm>
#include <utility>

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

Emulator::Emulator(const EmulatorOptions& options) : options_(options) {
  reset();
}

void Emulator::reset() {
  units_.assign(options_.sites.size(), {});
  if (options_.extended)
    for (Unit& unit : units_) unit.layout.range = extended_scale;
  running_units_ = 1;
  addressed_ = 1;
  group_ = streaming_ = paused_ = false;
  report_every_ = 1;
  error_ = 0;
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
  if (addressed_ < 1 || addressed_ > static_cast<int>(units_.size())) {
    error_ = 13;  // no such unit answers
    return {};
  }
  Unit& unit = units_[static_cast<std::size_t>(addressed_ - 1)];
  if (const auto format = format_of_command(bytes[0])) {
    unit.layout.format = *format;
    return {};
  }
  switch (bytes[0]) {
    case 'B': {
      streaming_ = false;
      std::string answer;
      for (const std::string& record : records()) answer += record;
      return answer;
    }
    case '@':
      streaming_ = true;
      break;
    case 'F':
      break;  // it runs already
    case 'G':
      streaming_ = false;
      break;
    case 'L':
      for (const HemisphereInfo& hemisphere : hemispheres)
        if (static_cast<char>(hemisphere.code[0]) == bytes[1] &&
            static_cast<char>(hemisphere.code[1]) == bytes[2])
          unit.hemisphere = hemisphere;
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
      unit.layout.button = bytes[1] != 0;
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
      error_ = 6;  // not understood, and otherwise ignored
  }
  return {};
}

std::string Emulator::examine(std::uint8_t parameter) {
  using std::string_literals::operator""s;
  const Unit& unit = units_[static_cast<std::size_t>(addressed_ - 1)];
  switch (parameter) {
    case status:
      return "\x08\xD1"s;
    case revision:
      return "\x03\x3C"s;
    case position_scaling:
      return unit.layout.range > short_range ? "\x01\x00"s : "\x00\x00"s;
    case error_code:
      return std::string(1, static_cast<char>(std::exchange(error_, std::uint8_t{0})));
    case model_name:
      return options_.extended ? "6DERC     "s : "6DFOB     "s;
    case group_mode:
      return group_ ? "\x01"s : "\x00"s;
    case system_status: {
      std::string bytes(max_units, '\0');
      // One unit that stands alone has no bus to tell about.
      for (int n = 0; units_.size() > 1 && n < static_cast<int>(units_.size()); ++n)
        bytes[static_cast<std::size_t>(n)] = static_cast<char>(
            accessible | has_receiver | (n < running_units_ ? running : std::uint8_t{0}) |
            (options_.extended && n == 0 ? extended_range : std::uint8_t{0}));
      return bytes;
    }
    default:
      return {};
  }
}

void Emulator::change(std::uint8_t parameter, std::string_view value) {
  Unit& unit = units_[static_cast<std::size_t>(addressed_ - 1)];
  switch (parameter) {
    case position_scaling:
      if (!options_.extended) unit.layout.range = value[0] != 0 ? long_range : short_range;
      break;
    case group_mode:
      group_ = value[0] != 0;
      break;
    case auto_configure:
      running_units_ = std::clamp<int>(value[0], 1, static_cast<int>(units_.size()));
      busy_until_ = now_ + configure_time;
      break;
    default:
      break;
  }
}

std::vector<std::string> Emulator::measure(const Frame& frame, Duration now) {
  now_ = now;
  readings_ = (frame.left ? mirrored(frame, options_.left_to_right_T) : frame).readings;
  held_ = frame.held.value_or(std::vector<std::uint8_t>());
  const bool due = measurements_++ % static_cast<std::uint64_t>(report_every_) == 0;
  if (!streaming() || !due || now_ < busy_until_) return {};
  return records();
}

std::vector<std::string> Emulator::records() const {
  std::vector<std::string> records;
  const std::size_t count = group_ ? static_cast<std::size_t>(running_units_) : 1;
  for (std::size_t n = 0; n < count; ++n) {
    Reading reading;  // a sensor that the source does not have lies at the transmitter
    for (const Reading& known : readings_)
      if (known.site == options_.sites[n]) reading = known;
    const Unit& unit = units_[n];
    if (reading.p_TS[unit.hemisphere.axis] * unit.hemisphere.sign < 0) reading.p_TS = -reading.p_TS;
    Layout layout = unit.layout;
    layout.group = group_;
    records.push_back(encode(reading.p_TS, reading.q_TS.normalized().toRotationMatrix(), layout,
                             static_cast<int>(n) + 1, n == 0 ? button_code(held_) : 0));
  }
  return records;
}

}  // namespace prehend::glove::bird
