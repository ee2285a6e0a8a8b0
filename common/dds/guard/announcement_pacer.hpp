#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "common/base/time.hpp"
#include "common/dds/guard/packet.hpp"

namespace prehend::dds {

/// Where a socket is.
struct Place {
  Ipv4 address{};
  std::uint16_t port = 0;
  auto operator<=>(const Place&) const = default;
};

/// What is said again and again at discovery: by whom, or to whom, and which one.
struct Saying {
  std::uint32_t writer = 0;  // of the announcement, or asked for what it has
  bool asks = false;
  std::uint64_t number = 0;  // of the announcement
};

/// Thins out what Fast DDS repeats at discovery. It sends its announcement to everybody whom it
/// knows, and to the group, not only every half second but each time that it meets one more; and it
/// asks each writer that it knows of, again and again, what it has, until that answers.
/// When N start at once, these are most of all packets, which then delay and lose what matters.
/// Here somebody is told the same at once, again after half a second, then less and less often, but
/// four times in a lease; the group hears every announcement that is not on the heels of another.
/// Whoever is new at a place gets all at once. Pure: times are told. Bounded.
class AnnouncementPacer {
 public:
  /// Is this to be sent there now? way: through which of the sockets.
  bool is_due(const Place& to, const void* way, const Saying& what, Time now);
  /// Somebody has announced that it is to be found there.
  void met(const Place& place, const GuidPrefix& participant);

  std::size_t size() const { return all_.size(); }
  static constexpr std::size_t max_places = 4096;
  static constexpr Duration min_gap = std::chrono::milliseconds(500),
                            max_gap = std::chrono::seconds(5),
                            group_gap = std::chrono::milliseconds(50);

 private:
  struct Sent {
    std::uint64_t number = 0;
    Duration gap{};
    Time next{};
  };
  struct There {
    std::optional<GuidPrefix> participant;
    std::map<std::tuple<const void*, std::uint32_t, bool>, Sent> sent;
  };
  There& find_or_make(const Place& place);

  std::map<Place, There> all_;
};

/// Where those hear of discovery by UDP who announce themselves in a sound message.
std::vector<Place> announced_places(std::span<const std::uint8_t> message);

/// What of this kind a message says; nothing: something else, or more.
std::optional<Saying> repeated_saying(std::span<const std::uint8_t> message);

}  // namespace prehend::dds
