#include "services/glove/devices/joint_emulator.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "services/glove/devices/hand_in_frame.hpp"

namespace prehend::glove::joint {
namespace {

constexpr char stop = 3;  // Ctrl-C
constexpr std::size_t max_command = 32;

std::string answer(char name, std::size_t value) {
  return {'?', name, static_cast<char>(value), '\0'};
}

}  // namespace

Emulator::Emulator(const EmulatorOptions& options)
    : options_(options),
      hand_(options.hand_scale),
      posture_(model::HumanHand::open_posture()),
      counts_(options.gains.gain.size(), 128) {}

std::string Emulator::receive(std::string_view bytes, Duration) {
  std::string answers;
  for (const char byte : bytes) {
    if (byte == stop) {
      streaming_ = false;
      pending_.clear();
      continue;
    }
    pending_.push_back(byte);
    answers += command();
    if (pending_.size() > max_command) pending_.clear();
  }
  return answers;
}

/// Of what has come, if it is complete. Small letters begin text that ends with a return.
std::string Emulator::command() {
  using std::string_literals::operator""s;
  const char first = pending_[0];
  const bool text = std::islower(static_cast<unsigned char>(first)) != 0;
  const std::size_t length = first == '?' ? 2 : 1;
  if (text ? pending_.back() != '\r' : pending_.size() < length) return {};
  const std::string complete = std::exchange(pending_, {});
  switch (first) {
    case '?':
      if (complete[1] == 'S' || complete[1] == 'N') return answer(complete[1], counts_.size());
      if (complete[1] == 'R') return answer('R', options_.right ? 1 : 0);
      break;
    case 'S':
      streaming_ = true;
      return {};
    case 'G':
      return encode(counts_, 'G');
    case 'u':
      return complete + "\n\0"s;
    case 't': {
      char* end = nullptr;
      const double first_factor = std::strtod(complete.c_str() + 1, &end);
      const double second_factor = std::strtod(end, nullptr);
      const double period = first_factor * second_factor / ticks;
      if (!(period >= 0.001 && period <= 60)) break;
      period_ = seconds(period);
      return complete + "\n\0"s;
    }
    default:
      break;
  }
  return "e?\0"s;
}

std::vector<std::string> Emulator::measure(const Frame& frame, Duration now) {
  if (const auto seen = hand_in(frame, hand_, posture_)) posture_ = seen->posture;
  const std::vector<double> counts = joint_counts(posture_, options_.gains);
  for (std::size_t s = 0; s < counts_.size(); ++s)
    counts_[s] = static_cast<std::uint8_t>(std::lround(counts[s]));
  if (!streaming_ || now < next_) return {};
  next_ = std::max(next_ + period_, now - period_);
  return {encode(counts_)};
}

}  // namespace prehend::glove::joint
