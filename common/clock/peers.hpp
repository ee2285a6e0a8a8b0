#pragma once

#include <array>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "common/base/time.hpp"
#include "common/clock/offset_filter.hpp"
#include "idl/Operation.h"

namespace prehend::clock {

/// The first twelve bytes of the identity of a DDS writer: its participant. Fast DDS makes the
/// first eight of them from host and process.
using Participant = std::array<std::uint8_t, 12>;

/// The clocks of the others as one process sees them. Pure: beacons in, beacons and offsets out.
/// Beacons are both question and answer: each takes back when the last one of everybody came. A
/// name is what a beacon claims; whose it is, its writer's identity tells, so that nobody speaks
/// for another's clock.
class Peers {
 public:
  /// service: our own key, as in our ServiceStatus.
  Peers(std::string service, std::string host);

  struct Heard {
    bool answer = false;           // the sender does not know our clock: send a beacon at once
    std::optional<Duration> step;  // its clock was found to have stepped by that, theirs minus ours
  };
  /// received: by our clock, when the beacon came. Our own beacons are left out.
  Heard hear(const v1::ClockBeacon& beacon, const Participant& from, Time received);

  /// What to send now. step: how far the system's clock has left ours since the start.
  v1::ClockBeacon beacon(Time now, Duration step);

  /// By how much stamps of this writer are ahead of our clock. Zero where we do not know, and where
  /// what we know of it is no larger than its uncertainty.
  Duration ahead(const Participant& writer, Time now) const;
  /// The same for the times that DDS itself notes, which follow steps of the system's clock.
  Duration system_ahead(const Participant& writer, Time now) const;
  /// The service of this writer; empty: not known.
  std::string service_of(const Participant& writer) const;
  /// By the key of the service, the best known of those who claim it; nullopt: not known.
  std::optional<Offset> offset(const std::string& service, Time now) const;

 private:
  struct Peer {
    Time sent, received;
    Duration step{};
    OffsetFilter filter;
  };
  using Entry = std::pair<const std::pair<std::string, Participant>, Peer>;
  template <class Wanted>
  const Entry* find(const Participant& writer, Wanted wanted) const;
  const Peer* find_measured(const Participant& writer) const;
  void forget(Time now);

  std::string service_, host_;
  std::map<std::pair<std::string, Participant>, Peer> peers_;  // by service and writer
  std::deque<std::int64_t> sent_;  // stamps of our last beacons: nothing else is taken back
};

}  // namespace prehend::clock
