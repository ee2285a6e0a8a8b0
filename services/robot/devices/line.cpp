#include "services/robot/devices/line.hpp"

#include <thread>
#include <utility>

namespace prehend::robot {
namespace {

constexpr Duration retry = std::chrono::milliseconds(200);

}  // namespace

Line::Line(Driver& driver, std::string port, int baud)
    : driver_(driver), port_name_(std::move(port)), baud_(baud) {}

Line::~Line() {
  if (port_) (void)port_->write(driver_.farewell());
}

void Line::exchange(Time now) {
  if (!port_) {
    if (now < next_try_) return;
    next_try_ = now + retry;
    auto opened = serial::SerialPort::open(port_name_, baud_);
    if (!opened) return driver_.disconnected(opened.error().message());
    port_.emplace(std::move(*opened));
    port_->discard_input();
    driver_.connected(now);
  }
  const auto heard = port_->read(Duration::zero());
  if (!heard) return lose(heard.error(), now);
  const std::string said = driver_.step(*heard, now);
  if (said.empty()) return;
  if (const auto sent = port_->write(said); !sent) lose(sent.error(), now);
}

void Line::lose(const Error& error, Time now) {
  port_.reset();
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
