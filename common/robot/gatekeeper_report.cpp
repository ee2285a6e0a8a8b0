// What the lab is told of a gate: the status of its service, and robot/gate.
#include <fmt/format.h>

#include "common/base/log.hpp"
#include "common/robot/bounded_text.hpp"
#include "common/robot/gatekeeper.hpp"

namespace prehend::robot {
namespace {

constexpr Duration patience = std::chrono::milliseconds(300);  // with silent commands
constexpr Duration noticed = std::chrono::seconds(1);          // a second writer is, for so long
constexpr Duration state_period = std::chrono::seconds(1);
constexpr const char* unled = "nobody sends robot/command; the hand stays as it is";

bool same(const v1::GateState& a, const v1::GateState& b) {
  return a.leader() == b.leader() && a.refused() == b.refused() && a.placed() == b.placed() &&
         a.stopped() == b.stopped() && a.consent() == b.consent() &&
         a.stopped_by() == b.stopped_by() && a.reason() == b.reason();
}

}  // namespace

std::string Gatekeeper::name_of(const gate::WriterId& writer) const {
  return shell_.writer_of({.participant = writer});
}

/// That the hand holds still then is the robot's own doing.
std::string Gatekeeper::missing(Time now) const {
  if (const auto& stop = gate_.stopped())
    return fmt::format("stopped by {}{}{}; prehend release ends it", stop->by,
                       stop->reason.empty() ? "" : ": ", stop->reason);
  if (!consented_) return "the deadman is not held; prehend consent holds it";
  const bool silent = now - last_obeyed_ > patience;
  // At the start commands are waited for, unless some come that cannot be obeyed.
  const bool refused = refused_ && now - refused_->at <= patience && (silent || last_obeyed_ > now);
  if (refused)
    return "robot/command is refused: " + refused_->why + ", of " + name_of(refused_->writer) +
           "; the hand stays as it is";
  if (silent) return unled;
  const auto leading = gate_.leader(now);
  if (leading && second_ && now - second_->at <= noticed && second_->writer != *leading)
    return "robot/command of " + name_of(second_->writer) + " is refused, for " +
           name_of(*leading) + " leads";
  return {};
}

void Gatekeeper::look_around(Time now) {
  std::string found = missing(now);
  if (found == missing_) return;
  missing_ = std::move(found);
  if (missing_.empty()) return shell_.status().running();
  log::warning("{}", missing_);
  shell_.status().degraded(missing_);
}

void Gatekeeper::tell(Time now) {
  v1::GateState state = state_;
  const auto leading = gate_.leader(now);
  put(state.leader(), leading ? name_of(*leading) : "", 127);
  const bool second =
      leading && second_ && now - second_->at <= noticed && second_->writer != *leading;
  put(state.refused(), second ? name_of(second_->writer) : "", 127);
  const auto& stop = gate_.stopped();
  state.placed(robot_.is_placed ? robot_.is_placed() : robot_.where().has_value());
  state.stopped(stop.has_value());
  state.consent(state.deadman() && consented_);
  put(state.stopped_by(), stop ? stop->by : "", 127);
  if (stop) {
    put(state.reason(), stop->reason, 127);
    state.since_ns(to_ns(stop->since));
  }
  if (now < next_state_ && same(state, state_)) return;
  next_state_ = now + state_period;
  state.sequence_number(state_.sequence_number() + 1);
  state.stamp_ns(to_ns(now));
  state.obeyed(obeyed_);
  state.counts().clear();
  for (const auto& [reason, number] : counts_) {
    v1::GateCount entry;
    put(entry.reason(), reason, 63);
    entry.count(number);
    state.counts().push_back(entry);
  }
  state_ = state;
  states_.publish(state_);
}

}  // namespace prehend::robot
