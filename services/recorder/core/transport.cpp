#include "services/recorder/core/transport.hpp"

#include <cmath>

namespace prehend::recorder {
namespace {

Duration scaled(Duration duration, double factor) {
  // At the original speed not a nanosecond is lost to rounding.
  if (factor == 1) return duration;
  return Duration(std::llround(static_cast<double>(duration.count()) * factor));
}

}  // namespace

Time Transport::position(Time now) const {
  return runs_ ? position_ + scaled(now - marked_, rate_) : position_;
}

Time Transport::when(Time position) const {
  return marked_ + scaled(position - position_, 1 / rate_);
}

void Transport::mark(Time now) {
  position_ = position(now);
  marked_ = now;
}

void Transport::run(Time now) {
  mark(now);
  runs_ = true;
}

void Transport::pause(Time now) {
  mark(now);
  runs_ = false;
}

void Transport::set_rate(Time now, double rate) {
  mark(now);
  rate_ = rate;
}

void Transport::seek(Time now, Time position) {
  marked_ = now;
  position_ = position;
}

}  // namespace prehend::recorder
