#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "services/robot/core/driver.hpp"
#include "services/robot/core/emulator.hpp"

namespace prehend::robot {

/// A driver and an emulated robot in computed time: what each says is heard by the other a little
/// later, or spoilt on the way.
template <class Robot, class Driver>
class ComputedWire {
 public:
  ComputedWire(Robot with_robot, Driver with_driver)
      : robot(std::move(with_robot)), driver(std::move(with_driver)) {
    driver.connected(now());
  }

  Time now() const { return from_ns(1'000'000'000) + time_; }
  Duration passed() const { return time_; }
  void run(double seconds_long) {
    constexpr Duration step = std::chrono::milliseconds(2);
    for (const Duration end = time_ + seconds(seconds_long); time_ < end; time_ += step) {
      if (tell) driver.follow(*tell, {}, now());
      const std::string said = driver.step(to_driver_, now());
      if (hear && !said.empty()) hear(said);
      std::string answer = robot.pass(time_);
      if (!said.empty() && !cut) answer += robot.receive(said, time_);
      to_driver_ = cut ? std::string() : spoil ? spoil(answer) : answer;
      if (driver.phase() == Phase::faulted && first_trouble.empty())
        first_trouble = driver.trouble();
      rejects += driver.take_rejects().size();
    }
  }

  Robot robot;
  Driver driver;
  std::optional<Eigen::VectorXd> tell;
  std::function<std::string(std::string)> spoil;
  std::function<void(const std::string&)> hear;  // what the driver says
  bool cut = false;
  std::size_t rejects = 0;
  std::string first_trouble;

 private:
  Duration time_{};
  std::string to_driver_;
};

}  // namespace prehend::robot
