// The serial driver against the emulated tracker on a real pseudo-terminal: start, formats, faults,
// silence, a port that goes and returns. Times are generous for a busy machine; the driver's own
// waits are 1.2 s for auto-configure.
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <prehend/base/random.hpp>
#include <prehend/glove_devices/bird_emulator.hpp>
#include <prehend/glove_devices/device.hpp>
#include <prehend/glove_devices/pseudo_terminal.hpp>
#include <thread>

namespace prehend::glove {
namespace {

using Clock = std::chrono::steady_clock;
using Eigen::Vector3d;

Duration since(Clock::time_point start) {
  return std::chrono::duration_cast<Duration>(Clock::now() - start);
}

Frame still_hand() {
  Frame frame;
  for (std::size_t s = 0; s < 4; ++s)
    frame.readings.push_back(
        {sites_by_address()[s], true, Vector3d(0.1 + 0.1 * static_cast<double>(s), -0.2, 0.9),
         Eigen::Quaterniond(Eigen::AngleAxisd(0.3 * static_cast<double>(s), Vector3d::UnitY()))});
  return frame;
}

std::filesystem::path link_path(const char* name) {
  return std::filesystem::temp_directory_path() /
         ("prehend_test_" + std::to_string(::getpid()) + name);
}

/// A tracker on a pseudo-terminal, from construction to destruction.
class Tracker {
 public:
  explicit Tracker(const std::filesystem::path& link, const bird::Faults& faults = {})
      : terminal_(PseudoTerminal::open(link)), emulator_(4, faults), thread_([this] { run(); }) {
    EXPECT_TRUE(terminal_) << terminal_.error().message();
  }
  ~Tracker() {
    stop_ = true;
    thread_.join();
  }
  std::atomic<bool> silent = false;

 private:
  void run() {
    const auto start = Clock::now();
    Duration due{};
    while (!stop_ && terminal_) {
      const std::string bytes = terminal_->read(due - since(start));
      if (!silent) terminal_->write(emulator_.receive(bytes, since(start)));
      if (since(start) < due) continue;
      due += std::chrono::milliseconds(10);
      const std::string records = emulator_.measure(still_hand(), since(start));
      if (!silent) terminal_->write(records);
    }
  }
  Expected<PseudoTerminal> terminal_;
  bird::Emulator emulator_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

/// Collects what a device says.
class Listener {
 public:
  DeviceSink sink() {
    return {.frame =
                [this](Frame frame) {
                  const std::lock_guard lock(mutex_);
                  frames_.push_back(std::move(frame));
                  news_.notify_all();
                },
            .degraded =
                [this](std::string line) {
                  const std::lock_guard lock(mutex_);
                  lines_.push_back(std::move(line));
                  news_.notify_all();
                },
            .drop =
                [this](std::string_view reason, std::uint64_t count) {
                  const std::lock_guard lock(mutex_);
                  drops_[std::string(reason)] += count;
                }};
  }
  /// Waits for that many more frames.
  bool frames(std::size_t count, double patience = 5) {
    std::unique_lock lock(mutex_);
    const std::size_t wanted = frames_.size() + count;
    return news_.wait_for(lock, seconds(patience), [&] { return frames_.size() >= wanted; });
  }
  bool says(const std::string& text, double patience = 5) {
    std::unique_lock lock(mutex_);
    return news_.wait_for(lock, seconds(patience), [&] {
      return std::any_of(lines_.begin(), lines_.end(), [&](const std::string& line) {
        return line.find(text) != std::string::npos;
      });
    });
  }
  std::vector<Frame> all() {
    const std::lock_guard lock(mutex_);
    return frames_;
  }
  std::map<std::string, std::uint64_t> drops() {
    const std::lock_guard lock(mutex_);
    return drops_;
  }
  std::size_t lines() {
    const std::lock_guard lock(mutex_);
    return lines_.size();
  }

 private:
  std::mutex mutex_;
  std::condition_variable news_;
  std::vector<Frame> frames_;
  std::vector<std::string> lines_;
  std::map<std::string, std::uint64_t> drops_;
};

std::unique_ptr<Device> driver(const std::filesystem::path& port,
                               const std::string& format = "position_matrix") {
  DeviceOptions options;
  options.port = port;
  options.format = format;
  auto device = find_device("nest_of_birds")->create(options);
  EXPECT_TRUE(device) << device.error().message();
  return std::move(*device);
}

/// Positions to half a step of 14 bits at 72 inches in each coordinate, rotations to 6e-4 rad.
void expect_still_hand(const Frame& frame) {
  const Frame truth = still_hand();
  ASSERT_EQ(frame.readings.size(), 4u);
  for (std::size_t s = 0; s < 4; ++s) {
    EXPECT_EQ(frame.readings[s].site, truth.readings[s].site);
    EXPECT_TRUE(frame.readings[s].valid);
    EXPECT_LT((frame.readings[s].p_TS - truth.readings[s].p_TS).norm(), 3e-4);
    EXPECT_LT(frame.readings[s].q_TS.normalized().angularDistance(truth.readings[s].q_TS), 1e-3);
  }
}

TEST(NestOfBirds, StreamsEveryFormatAndStartsQuickly) {
  const auto link = link_path("formats");
  const Tracker tracker(link);
  bool cold = true;
  for (const char* format : {"position_matrix", "position_quaternion", "position_angles"}) {
    Listener listener;
    const auto device = driver(link, format);
    const auto start = Clock::now();
    device->start(listener.sink());
    ASSERT_TRUE(listener.frames(1)) << format;
    // A tracker that runs already need not be configured again.
    EXPECT_LT(to_seconds(since(start)), cold ? 2.5 : 1.0) << format;
    cold = false;
    ASSERT_TRUE(listener.frames(10)) << format;
    const auto frames = listener.all();
    for (std::size_t n = 1; n < frames.size(); ++n) {
      EXPECT_EQ(frames[n].sequence, frames[n - 1].sequence + 1);
      EXPECT_GT(frames[n].stamp, frames[n - 1].stamp);
    }
    expect_still_hand(frames.back());
    EXPECT_EQ(listener.lines(), 0u);
  }
}

TEST(NestOfBirds, CountsGarbageAndGoesOn) {
  const auto link = link_path("garbage");
  const Tracker tracker(link, {.garbage = 0.05, .drop_bytes = 0.05});
  Listener listener;
  const auto device = driver(link);
  device->start(listener.sink());
  ASSERT_TRUE(listener.frames(100));
  EXPECT_GT(listener.drops()["garbage bytes"], 0u);
  std::size_t whole = 0;
  const Frame truth = still_hand();
  for (const Frame& frame : listener.all()) {
    bool good = true;
    for (std::size_t s = 0; s < 4; ++s)
      good &= frame.readings[s].valid &&
              (frame.readings[s].p_TS - truth.readings[s].p_TS).norm() < 3e-4;
    whole += good;
  }
  // A tenth of the records is damaged: about 0.9^4 of the frames stay whole.
  EXPECT_GT(whole, listener.all().size() / 2);
}

TEST(NestOfBirds, ComesBackWhenThePortDoes) {
  const auto link = link_path("gone");
  Listener listener;
  const auto device = driver(link);
  device->start(listener.sink());
  EXPECT_TRUE(listener.says("there is no such port"));
  {
    const Tracker tracker(link);
    ASSERT_TRUE(listener.frames(5));
  }
  EXPECT_TRUE(listener.says("disappeared"));
  const Tracker tracker(link);
  ASSERT_TRUE(listener.frames(5));
  EXPECT_LE(listener.lines(), 4u) << "one line for a state, not one for a try";
}

TEST(NestOfBirds, StartsASilentTrackerAgain) {
  const auto link = link_path("silent");
  Tracker tracker(link);
  Listener listener;
  const auto device = driver(link);
  device->start(listener.sink());
  ASSERT_TRUE(listener.frames(5));
  tracker.silent = true;
  EXPECT_TRUE(listener.says("silent"));
  tracker.silent = false;
  EXPECT_TRUE(listener.frames(5));
}

TEST(NestOfBirds, RefusesAWrongConfiguration) {
  const auto kind = find_device("nest_of_birds");
  ASSERT_TRUE(kind);
  DeviceOptions options;
  EXPECT_FALSE(kind->create(options)) << "no port";
  options.port = "/dev/ttyUSB0";
  EXPECT_TRUE(kind->create(options)) << "need not be there yet";
  options.format = "matrix";
  EXPECT_FALSE(kind->create(options)) << "no position in it";
  options.format = "position_matrix";
  options.sensors = 0;
  EXPECT_FALSE(kind->create(options));
  EXPECT_FALSE(find_device("mind reader"));
}

}  // namespace
}  // namespace prehend::glove
