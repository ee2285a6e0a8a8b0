#include "services/mapping/core/arbitration.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/named_values.hpp"

namespace prehend::mapping {

namespace {
constexpr auto phase_names = named_values<Phase>({{Phase::direct, "direct"},
                                                  {Phase::engaging, "engaging"},
                                                  {Phase::engaged, "engaged"},
                                                  {Phase::gripping, "gripping"},
                                                  {Phase::leaving, "leaving"}});
constexpr auto event_names = named_values<Event>({{Event::in_reach, "in reach"},
                                                  {Event::lost, "lost"},
                                                  {Event::touched, "touched"},
                                                  {Event::released, "released"},
                                                  {Event::full, "full"},
                                                  {Event::empty, "empty"}});
}  // namespace

std::string_view to_string(Phase phase) {
  return phase_names.name(phase);
}

std::string_view to_string(Event event) {
  return event_names.name(event);
}

std::string drawing() {
  std::string text = fmt::format("stateDiagram-v2\n    [*] --> {}\n", to_string(Phase::direct));
  for (const Transition& t : transitions)
    text +=
        fmt::format("    {} --> {}: {}\n", to_string(t.from), to_string(t.to), to_string(t.event));
  return text;
}

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
