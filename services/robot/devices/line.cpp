#include "services/robot/devices/line.hpp"

#include <thread>
#include <utility>

namespace prehend::robot {
namespace {

constexpr Duration retry = std::chrono::milliseconds(200);
constexpr Duration hearing = std::chrono::milliseconds(300);  // a line of text, at any baud rate
constexpr int max_pieces = 64;                                // that are read at once

}  // namespace

Line::Line(Driver& driver, Opener open) : driver_(driver), open_(std::move(open)) {}

Line::~Line() {
  if (!channel_) return;
  if (const std::string said = driver_.farewell(); !said.empty()) (void)channel_->write(said);
}

void Line::exchange(Time now) {
  if (!channel_) {
    if (now < next_try_) return;
    next_try_ = now + retry;
    auto opened = open_();
    if (!opened) return driver_.disconnected(opened.error().message());
    channel_ = std::move(*opened);
    first_heard_.reset();
    driver_.connected(now);
  }
  hears_ = first_heard_ && now - *first_heard_ > hearing;
  // Messages come one by one; who sends more than can be read is heard at the next call.
  for (int n = 0; n < max_pieces; ++n) {
    const auto heard = channel_->read();
    if (!heard) return lose(heard.error(), now);
    if (n > 0 && heard->empty()) return;
    if (!heard->empty() && !first_heard_) first_heard_ = now;
    const std::string said = driver_.step(*heard, now);
    if (!said.empty())
      if (const auto sent = channel_->write(said); !sent) return lose(sent.error(), now);
    if (heard->empty()) return;
  }
}

Error Line::trouble(const std::string& where, const std::string& hint) const {
  Error silence{driver_.trouble(), where, hint};
  if (driver_.phase() != Phase::offline || !channel_ || !hears_) return silence;
  return channel_->unanswered(std::move(silence));
}

void Line::lose(const Error& error, Time now) {
  channel_.reset();
  next_try_ = now + retry;
  driver_.disconnected(error.message());
}

bool exchange_until(Line& line, Duration longest, const std::function<bool()>& done) {
  const auto now = [] {
    return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
  };
  const Time end = now() + longest;
  while (!done()) {
    const Time time = now();
    if (time > end) return false;
    line.exchange(time);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace prehend::robot
