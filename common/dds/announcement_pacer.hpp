#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "common/base/time.hpp"
#include "common/dds/packet.hpp"

namespace prehend::dds {

/// Where a socket is.
struct Place {
  Ipv4 address{};
  std::uint16_t port = 0;
  auto operator<=>(const Place&) const = default;
};

/// Thins out repeated announcements of a participant. Fast DDS sends its announcement to everybody
/// whom it knows, and to the group, not only every half second but each time that it meets one
/// more: when N start at once, that is N³ packets, which then delay and lose what matters. Here
/// somebody gets the same announcement at once, again after 0.2 s, then less and less often, but
/// four times in a lease; the group hears every one that is not on the heels of another. Whoever is
/// new at a place gets it at once. Pure: times are told. Bounded.
class AnnouncementPacer {
 public:
  /// Is the announcement of this number to be sent there now? way: through which of the sockets.
  bool is_due(const Place& to, const void* way, std::uint64_t number, Time now);
  /// Somebody has announced that it is to be found there.
  void met(const Place& place, const GuidPrefix& participant);

  std::size_t size() const { return all_.size(); }
  static constexpr std::size_t max_places = 4096;
  static constexpr Duration min_gap = std::chrono::milliseconds(200),
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
    std::map<const void*, Sent> ways;
  };
  There& find_or_make(const Place& place);

  std::map<Place, There> all_;
};

/// Where those hear of discovery by UDP who announce themselves in a sound message.
std::vector<Place> announced_places(std::span<const std::uint8_t> message);

/// The number of an announcement that a participant makes of itself; nothing: the message is
/// something else, or more.
std::optional<std::uint64_t> announcement_number(std::span<const std::uint8_t> message);

}  // namespace prehend::dds
