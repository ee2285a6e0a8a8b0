#include "arbitration.hpp"

#include <algorithm>

namespace prehend::mapping {

void Arbitration::handle(Event event) {
  for (const Transition& transition : transitions)
    if (transition.from == phase_ && transition.event == event) {
      phase_ = transition.to;
      return;
    }
}

void Arbitration::step(bool in_reach, bool touching, Duration elapsed) {
  // Without an object that was engaged before, a touch means nothing here.
  handle(touching ? Event::touched : Event::released);
  handle(in_reach ? Event::in_reach : Event::lost);
  const double change = to_seconds(std::max(elapsed, Duration::zero())) / to_seconds(ramp_);
  if (phase_ == Phase::engaging || phase_ == Phase::gripping)
    weight_ = std::min(1.0, weight_ + change);
  else if (phase_ == Phase::leaving)
    weight_ = std::max(0.0, weight_ - change);
  if (weight_ == 1.0) handle(Event::full);
  if (weight_ == 0.0) handle(Event::empty);
}

}  // namespace prehend::mapping
