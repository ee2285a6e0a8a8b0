#include "common/gate/command_gate.hpp"

#include <algorithm>
#include <utility>

#include "common/base/named_values.hpp"
#include "common/base/time_between.hpp"

namespace prehend::gate {
namespace {

constexpr double far_off = 10;              // m: no hand works there
constexpr double tolerated_outside = 0.01;  // of a DoF's range, beyond its limits
constexpr std::size_t max_heard = 16;       // writers
/// What somebody sets for ages and silences, at most: nobody means a minute, and nothing overflows.
constexpr Duration max_set = std::chrono::minutes(1);

constexpr auto refusal_names =
    named_values<Refusal>({{Refusal::not_finite, "command not finite"},
                           {Refusal::another_hand, "command for another hand"},
                           {Refusal::another_model, "command for another model"},
                           {Refusal::wrong_length, "command of wrong length"},
                           {Refusal::far_away, "command far away"},
                           {Refusal::outside_limits, "command outside limits"},
                           {Refusal::too_old, "command too old"},
                           {Refusal::from_future, "command from the future"},
                           {Refusal::not_newer, "command not newer than the last"},
                           {Refusal::second_writer, "command of a second writer"},
                           {Refusal::stopped, "command while stopped"},
                           {Refusal::no_consent, "command without consent"}});

}  // namespace

std::string_view to_string(Refusal refusal) {
  return refusal_names.name(refusal, "command refused");
}

Expected<CommandGate> CommandGate::create(const model::HandModel& hand, GateOptions options,
                                          Limits limits, Where where) {
  if (limits.joint.size() != hand.dofs().size() ||
      limits.effort.size() != static_cast<Eigen::Index>(hand.dofs().size()))
    return fail("limits are those of another hand", "gate");
  if (auto sound = check(limits); !sound) return tl::unexpected(sound.error());
  for (const Duration set : {options.max_age, options.max_silence, options.max_consent_age})
    if (set <= Duration::zero() || set > max_set)
      return fail("times must be above 0 s and at most 60 s", "gate.max_age, gate.max_silence");
  return CommandGate(hand, std::move(options), std::move(limits), std::move(where));
}

CommandGate::CommandGate(const model::HandModel& hand, GateOptions options, Limits limits,
                         Where where)
    : hand_(hand),
      options_(std::move(options)),
      motion_(std::move(limits)),
      where_(std::move(where)) {}

tl::expected<Passed, Refusal> CommandGate::admit(const Command& command, Time now) {
  if (const auto refused = judge(command, now)) return tl::unexpected(*refused);
  start();
  return motion_.step(command.place, command.stamp, now);
}

void CommandGate::start() {
  if (!std::exchange(starts_, false)) return;
  // Where nobody knows that, what it was told last counts.
  auto here = where_ ? where_() : std::nullopt;
  if (!here) here = motion_.place();
  if (here) motion_.start(*here);
}

void CommandGate::stop(const std::string& by, const std::string& reason, Time now) {
  if (!stop_) stop_ = Stop{by, reason, now};
  stop_->newest = std::max(stop_->newest, now);
  starts_ = true;
}

void CommandGate::release() {
  stop_.reset();
  starts_ = true;
}

bool CommandGate::may_release(Time given) const {
  return !stop_ || given > std::max(stop_->since, stop_->newest);
}

void CommandGate::consent(const WriterId& writer, bool held, Time stamp, Time now) {
  if (!is_within(stamp, now, options_.max_age)) return;
  if (!held && holder_ != writer) return;
  // What comes late or twice must not undo that it was let go, whoever spoke in between. Who spoke
  // so long ago that it would be too old if it came again may be forgotten.
  std::erase_if(told_, [&](const auto& entry) {
    return entry.first != writer && between(entry.second, now) > options_.max_age;
  });
  const auto known = told_.find(writer);
  if (known == told_.end() ? told_.size() >= max_heard : stamp <= known->second) return;
  told_[writer] = stamp;
  holder_ = held ? std::optional(writer) : std::nullopt;
  held_ = now;
}

bool CommandGate::has_consent(Time now) const {
  return !options_.deadman || (holder_ && between(held_, now) <= options_.max_consent_age);
}

Passed CommandGate::go(const Place& place, Time now) {
  start();
  return motion_.step(place, now, now);
}

std::optional<Refusal> CommandGate::judge(const Command& command, Time now) {
  if (const auto refused = judge_content(command)) return refused;
  const Duration age = between(command.stamp, now);
  if (age > options_.max_age) return Refusal::too_old;
  if (age < -options_.max_age) return Refusal::from_future;
  if (!make_room(command.writer, now)) return Refusal::second_writer;
  if (!is_newer(command, now)) return Refusal::not_newer;
  if (const auto leading = leader(now); leading && *leading != command.writer)
    return Refusal::second_writer;
  lead(command.writer);
  led_ = now;
  if (stop_) return Refusal::stopped;
  if (has_consent(now)) return std::nullopt;
  starts_ = true;
  return Refusal::no_consent;
}

std::optional<Refusal> CommandGate::judge_content(const Command& command) const {
  if (command.hand != options_.hand) return Refusal::another_hand;
  if (command.model != hand_.name()) return Refusal::another_model;
  const Eigen::VectorXd& dof = command.place.dof;
  if (dof.size() != static_cast<Eigen::Index>(hand_.dofs().size())) return Refusal::wrong_length;
  const Eigen::VectorXd& effort = command.place.effort;
  if (effort.size() != 0 && effort.size() != dof.size()) return Refusal::wrong_length;
  if (!dof.allFinite() || !effort.allFinite() || !is_finite(command.place.X_WB))
    return Refusal::not_finite;
  if ((effort.array() < 0).any()) return Refusal::outside_limits;
  if (command.place.X_WB.translation().norm() > far_off) return Refusal::far_away;
  for (Eigen::Index i = 0; i < dof.size(); ++i) {
    const model::HandDof& limits = hand_.dofs()[static_cast<std::size_t>(i)];
    const double slack = tolerated_outside * (limits.upper - limits.lower);
    if (dof[i] < limits.lower - slack || dof[i] > limits.upper + slack)
      return Refusal::outside_limits;
  }
  return std::nullopt;
}

/// By its number. Its stamp may be older: mapping answers a posture that came late after it has
/// told the hand to stay, and the age is bounded. Who never counts, but always says 0, is judged by
/// stamps; who counts anew (a recording that begins again) is heard after a silence.
bool CommandGate::is_newer(const Command& command, Time now) {
  const auto known = heard_.find(command.writer);
  if (known == heard_.end()) {
    heard_[command.writer] = {command.sequence, command.stamp, now};
    return true;
  }
  Heard& last = known->second;
  const bool again =
      between(last.at, now) > options_.max_silence || (command.sequence == 0 && last.sequence == 0);
  if (command.sequence <= last.sequence && !(again && command.stamp > last.stamp)) return false;
  last = {command.sequence, std::max(last.stamp, command.stamp), now};
  return true;
}

/// Forgets writers where they are too many, but none whose commands could be obeyed a second time.
/// There is always room for who leads.
bool CommandGate::make_room(const WriterId& writer, Time now) {
  if (heard_.size() < max_heard || heard_.contains(writer)) return true;
  auto oldest = heard_.end();
  for (auto at = heard_.begin(); at != heard_.end(); ++at)
    if (at->first != leader_ && (oldest == heard_.end() || at->second.at < oldest->second.at))
      oldest = at;
  if (writer != leader_ && between(oldest->second.stamp, now) <= options_.max_age) return false;
  heard_.erase(oldest);
  return true;
}

std::optional<WriterId> CommandGate::leader(Time now) const {
  return leader_ && between(led_, now) <= options_.max_silence ? leader_ : std::nullopt;
}

void CommandGate::take_over(const WriterId& writer, Time now) {
  lead(writer);
  led_ = now;
}

void CommandGate::lead(const WriterId& writer) {
  if (leader_ == writer) return;
  starts_ = true;
  leader_ = writer;
  ++leads_;
}

}  // namespace prehend::gate
