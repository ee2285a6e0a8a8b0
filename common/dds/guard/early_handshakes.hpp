#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "common/base/time.hpp"
#include "common/dds/guard/packet.hpp"

namespace prehend::dds {

/// The last message of a handshake of each who was not admitted when it came. In a crowd one side
/// admits the other first and begins; Fast DDS would repeat what was lost only after half a second,
/// and after another. Pure. Bounded: the oldest goes.
class EarlyHandshakes {
 public:
  void keep(const GuidPrefix& sender, std::span<const std::uint8_t> message, Time now) {
    if (message.size() > max_size) return;
    if (kept_.size() >= max_kept && !kept_.contains(sender)) forget_oldest();
    kept_[sender] = {{message.begin(), message.end()}, now};
  }
  /// The sender has been admitted.
  std::optional<std::vector<std::uint8_t>> take(const GuidPrefix& sender, Time now) {
    const auto found = kept_.find(sender);
    if (found == kept_.end()) return std::nullopt;
    Kept kept = std::move(found->second);
    kept_.erase(found);
    if (now - kept.at > max_age) return std::nullopt;
    return std::move(kept.message);
  }
  bool empty() const { return kept_.empty(); }

  static constexpr std::size_t max_kept = 256, max_size = 16384;
  static constexpr Duration max_age = std::chrono::seconds(2);

 private:
  struct Kept {
    std::vector<std::uint8_t> message;
    Time at{};
  };
  void forget_oldest() {
    auto oldest = kept_.begin();
    for (auto one = kept_.begin(); one != kept_.end(); ++one)
      if (one->second.at < oldest->second.at) oldest = one;
    kept_.erase(oldest);
  }

  std::map<GuidPrefix, Kept> kept_;
};

}  // namespace prehend::dds
