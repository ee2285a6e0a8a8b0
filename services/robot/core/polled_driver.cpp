#include "services/robot/core/polled_driver.hpp"

#include <fmt/format.h>

namespace prehend::robot {
namespace {

constexpr Duration rest = std::chrono::milliseconds(500);
constexpr Duration of_the_system = std::chrono::milliseconds(40);

}  // namespace

Duration patience_for(std::size_t bytes, int baud) {
  return of_the_system + seconds(20.0 * static_cast<double>(bytes) / baud);
}

void PolledDriver::connected(Time now) {
  open_ = true;
  waiting_ = false;
  silence_.end(now);
  free_ = rests_until_ = now;
  suspicion_.clear();
  forget();
  begin(now);
  if (phase_ == Phase::offline) trouble_ = "does not answer";
}

void PolledDriver::disconnected(const std::string& why) {
  open_ = false;
  be(Phase::offline, why);
}

std::string PolledDriver::step(std::string_view heard, Time now) {
  if (!open_) return {};
  if (now < rests_until_) return {};
  silence_.listen(now);
  feed(heard);
  for (Heard said = hear(now); said != Heard::nothing; said = hear(now)) {
    if (said == Heard::foreign) continue;
    waiting_ = false;
    free_ = now;
    if (said == Heard::refusal) continue;
    suspicion_.clear();
    silence_.end(now);
  }
  if (silence_.listened() > options_.lost_after)
    return lose(!suspicion_.empty() ? suspicion_
                : identity_.empty() ? "does not answer"
                                    : "the wire is lost",
                now);
  if (const auto why = what_is_wrong()) return lose(*why, now);
  if (waiting_ && now - asked_ > pace_.patience) {
    waiting_ = false;
    if (phase_ != Phase::offline) count_reject("no answer");
  }
  if (waiting_ || now - free_ < pace_.pause) return {};
  std::string said = question(now);
  if (said.empty()) return {};
  forget();
  waiting_ = true;
  asked_ = now;
  return said;
}

bool PolledDriver::is_of_another(int asked, int answered) {
  if (answered == asked) return false;
  suspect(fmt::format("id {} does not answer, but id {} does", asked, answered));
  count_reject("answer of another");
  return true;
}

/// Something is wrong: it stays where it was seen last, and is asked anew after a rest.
std::string PolledDriver::lose(const std::string& why, Time now) {
  std::string said = stay();
  be(identity_.empty() ? Phase::offline : Phase::faulted, why);
  rests_until_ = now + rest;
  silence_.end(rests_until_);
  free_ = rests_until_;
  waiting_ = false;
  suspicion_.clear();
  forget();
  begin(now);
  return said;
}

}  // namespace prehend::robot
