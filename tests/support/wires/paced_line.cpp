#include "tests/support/wires/paced_line.hpp"

#include <atomic>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>
#include <utility>

#include "common/serial/pseudo_terminal.hpp"
#include "services/robot/devices/emulation.hpp"
#include "services/robot/devices/line.hpp"
#include "tests/support/hands.hpp"

namespace prehend::test {
namespace {

constexpr Duration gets_ready_in = std::chrono::seconds(40);  // at the slowest

/// Counts what goes through another one.
class CountingChannel final : public robot::Channel {
 public:
  CountingChannel(std::unique_ptr<robot::Channel> channel, std::size_t& bytes)
      : channel_(std::move(channel)), bytes_(bytes) {}
  Expected<std::string> read() override {
    auto heard = channel_->read();
    if (heard) bytes_ += heard->size();
    return heard;
  }
  Expected<void> write(std::string_view said) override {
    bytes_ += said.size();
    return channel_->write(said);
  }

 private:
  std::unique_ptr<robot::Channel> channel_;
  std::size_t& bytes_;
};

/// The emulated hand in a thread, as `prehend robot emulate` runs it.
class FarEnd {
 public:
  FarEnd(const WiredHand& wired, int baud) : robot_(wired.far({.initialized = true})) {
    options_.baud = baud;
    options_.plug_in = [this]() -> Expected<std::unique_ptr<serial::Plug>> {
      auto terminal = serial::PseudoTerminal::open("");
      if (!terminal) return tl::unexpected(terminal.error());
      path_ = terminal->path();
      plugged_ = true;
      plugged_.notify_one();
      return std::make_unique<serial::PseudoTerminal>(std::move(*terminal));
    };
    thread_ = std::jthread([this](const std::stop_token& stop) {
      (void)robot::emulate(options_, *robot_, [&] { return stop.stop_requested(); });
    });
    plugged_.wait(false);
  }
  const std::string& path() const { return path_; }

 private:
  std::unique_ptr<robot::Emulator> robot_;
  robot::EmulationOptions options_;
  std::string path_;
  std::atomic<bool> plugged_ = false;
  std::jthread thread_;  // last: joined before the rest goes
};

}  // namespace

Cycle measure_cycle(const WiredHand& wired, int baud, double rate, double seconds_long) {
  const model::HandModel& model = hand(wired.hand);
  const FarEnd far(wired, baud);
  const auto driver = wired.near({.baud = baud, .rate = rate});
  std::size_t bytes = 0;
  const auto open = robot::serial_channel(far.path(), baud);
  robot::Line line(*driver, [&]() -> Expected<std::unique_ptr<robot::Channel>> {
    auto channel = open();
    if (!channel) return tl::unexpected(channel.error());
    return std::make_unique<CountingChannel>(std::move(*channel), bytes);
  });

  auto next = std::chrono::steady_clock::now();
  const auto begin = next;
  Cycle cycle;
  Time read{};
  std::optional<std::chrono::steady_clock::time_point> ready;
  std::size_t rounds = 0;
  while (!ready || next < *ready + seconds(seconds_long)) {
    next += robot_tick;
    std::this_thread::sleep_until(next);
    line.exchange(std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now()));
    if (driver->phase() != robot::Phase::ready) {
      if (!ready && std::chrono::steady_clock::now() < begin + gets_ready_in) continue;
      cycle.trouble = driver->trouble();
      return cycle;
    }
    if (!ready) {
      ready = next;
      bytes = rounds = 0;
    }
    if (std::exchange(read, driver->reading()->stamp) != driver->reading()->stamp) ++rounds;
    // Back and forth through the middle half of each range in 4 s.
    const double t = std::chrono::duration<double>(next - *ready).count();
    const double share = 0.5 - 0.25 * std::cos(2 * M_PI * t / 4);
    Eigen::VectorXd goal(static_cast<Eigen::Index>(model.dofs().size()));
    for (Eigen::Index d = 0; d < goal.size(); ++d) {
      const model::HandDof& dof = model.dofs()[static_cast<std::size_t>(d)];
      goal[d] = dof.lower + share * (dof.upper - dof.lower);
    }
    driver->follow(goal, {}, driver->reading()->stamp);
  }
  cycle.rounds = static_cast<double>(rounds) / seconds_long;
  cycle.bytes = static_cast<double>(bytes) / static_cast<double>(std::max<std::size_t>(rounds, 1));
  return cycle;
}

}  // namespace prehend::test
