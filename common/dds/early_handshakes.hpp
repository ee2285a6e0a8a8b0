#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/base/time.hpp"
#include "common/dds/packet.hpp"

namespace prehend::dds {

/// The last message of a handshake of each who was not admitted when it came, and the way it came:
/// whoever admits it may have heard the announcement elsewhere. In a crowd one side admits the
/// other first and begins; Fast DDS would repeat what was lost only after half a second, and after
/// another. Pure. Bounded: the oldest goes.
template <class Way>
class EarlyHandshakes {
 public:
  struct Kept {
    std::vector<std::uint8_t> message;
    Way way;
    Time at{};
  };
  void keep(const GuidPrefix& sender, std::span<const std::uint8_t> message, Way way, Time now) {
    if (message.size() > max_size) return;
    if (kept_.size() >= max_kept && !kept_.contains(sender)) forget_oldest();
    kept_.insert_or_assign(sender, Kept{{message.begin(), message.end()}, std::move(way), now});
  }
  /// The sender has been admitted.
  std::optional<Kept> take(const GuidPrefix& sender, Time now) {
    const auto found = kept_.find(sender);
    if (found == kept_.end()) return std::nullopt;
    Kept kept = std::move(found->second);
    kept_.erase(found);
    if (now - kept.at > max_age) return std::nullopt;
    return kept;
  }
  void clear() { kept_.clear(); }
  bool empty() const { return kept_.empty(); }

  static constexpr std::size_t max_kept = 256, max_size = 16384;
  static constexpr Duration max_age = std::chrono::seconds(2);

 private:
  void forget_oldest() {
    auto oldest = kept_.begin();
    for (auto one = kept_.begin(); one != kept_.end(); ++one)
      if (one->second.at < oldest->second.at) oldest = one;
    kept_.erase(oldest);
  }

  std::map<GuidPrefix, Kept> kept_;
};

}  // namespace prehend::dds
