#include "common/clock/offset_filter.hpp"

#include <algorithm>

namespace prehend::clock {
namespace {

Duration drift_in(Duration time) {
  return std::chrono::duration_cast<Duration>(OffsetFilter::drift * time) + Duration(1);
}

}  // namespace

Offset OffsetFilter::aged(const Bound& bound, Time now) {
  return {bound.offset.offset,
          bound.offset.uncertainty + drift_in(std::max(now - bound.when, Duration::zero()))};
}

bool OffsetFilter::add(const Exchange& exchange) {
  const Duration lower = exchange.answered - exchange.received;
  const Duration upper = exchange.arrived - exchange.sent;
  const Duration round = exchange.received - exchange.sent;
  // While it lasted the clocks may have run apart.
  const Duration apart = drift_in(round);
  if (round < Duration::zero() || exchange.answered < exchange.arrived || upper + apart < lower)
    return false;
  const Duration width = std::max(upper - lower, Duration::zero());
  const Bound bound{exchange.received, {lower + (upper - lower) / 2, width / 2 + apart}};
  if (const auto believed = at(exchange.received);
      believed && std::chrono::abs(believed->offset - bound.offset.offset) >
                      believed->uncertainty + bound.offset.uncertainty) {
    ++steps_;
    count_ = next_ = 0;
  }
  bounds_[next_] = bound;
  next_ = (next_ + 1) % bounds_.size();
  count_ = std::min(count_ + 1, bounds_.size());
  return true;
}

std::optional<Offset> OffsetFilter::at(Time now) const {
  std::optional<Offset> best;
  for (std::size_t i = 0; i < count_; ++i)
    if (const Offset one = aged(bounds_[i], now); !best || one.uncertainty < best->uncertainty)
      best = one;
  return best;
}

}  // namespace prehend::clock
