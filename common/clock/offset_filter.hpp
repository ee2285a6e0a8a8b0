#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/base/time.hpp"

namespace prehend::clock {

/// The four stamps of NTP (RFC 5905, section 8): a message to the other side and its answer.
struct Exchange {
  Time sent;      // of ours, by our clock
  Time arrived;   // there, by their clock
  Time answered;  // there, by their clock
  Time received;  // of the answer, by our clock
};

struct Offset {
  Duration offset{};       // their clock minus ours
  Duration uncertainty{};  // the true offset is no further from that
};

/// The offset between two clocks, from exchanges over a network whose delays are not known. A
/// message cannot arrive before it was sent, so each exchange bounds the offset from both sides:
///   answered - received <= offset <= arrived - sent,
/// a span as wide as the delay there and back, whatever part of it each way took. The span grows
/// with age, because clocks drift; the exchange whose span is the smallest now is believed.
class OffsetFilter {
 public:
  /// Most by which two clocks may run apart, s/s: twice what a cheap quartz is off.
  static constexpr double drift = 1e-4;

  /// False when no pair of clocks can have given these stamps; it is then left out. Exchanges come
  /// in order of `received`. One that contradicts what is believed means that a clock has stepped:
  /// what was before is forgotten.
  bool add(const Exchange& exchange);
  /// nullopt before the first exchange.
  std::optional<Offset> at(Time now) const;
  /// Contradictions so far.
  std::uint64_t steps() const { return steps_; }

 private:
  struct Bound {
    Time when;  // by our clock
    Offset offset;
  };
  static Offset aged(const Bound& bound, Time now);

  std::array<Bound, 16> bounds_{};  // the last ones
  std::size_t next_ = 0, count_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace prehend::clock
