#include "services/glove/devices/joint_protocol.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace prehend::glove::joint {

std::string encode(const Counts& counts, char kind) {
  std::string bytes(1, kind);
  for (const std::uint8_t count : counts)
    bytes.push_back(static_cast<char>(std::max<std::uint8_t>(count, 1)));
  bytes.push_back('\0');
  return bytes;
}

std::vector<Counts> RecordParser::feed(std::string_view bytes) {
  std::vector<Counts> records;
  for (const char byte : bytes) {
    if (byte != '\0') {
      if (pending_.size() > sensors_) {
        garbage_ += pending_.size();
        pending_.clear();
        lost_ = true;
      }
      pending_.push_back(byte);
      continue;
    }
    if (!lost_ && pending_.size() == sensors_ + 1 && (pending_[0] == 'S' || pending_[0] == 'G'))
      records.emplace_back(pending_.begin() + 1, pending_.end());
    else
      garbage_ += pending_.size() + 1;
    pending_.clear();
    lost_ = false;
  }
  return records;
}

std::string period_command(double rate) {
  // Two factors of at most 65535 each.
  const double period = ticks / rate;
  const double second = std::ceil(period / 65535);
  return fmt::format("t {:.0f} {:.0f}\r", period / second, second);
}

std::optional<std::uint8_t> answered(char name, std::string_view bytes) {
  if (bytes.size() < 4 || bytes.back() != '\0') return std::nullopt;
  bytes.remove_prefix(bytes.size() - 4);
  if (bytes[0] != '?' || bytes[1] != name) return std::nullopt;
  return static_cast<std::uint8_t>(bytes[2]);
}

}  // namespace prehend::glove::joint
