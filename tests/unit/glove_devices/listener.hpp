#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <condition_variable>
#include <future>
#include <map>
#include <mutex>
#include <thread>

#include "services/glove/devices/device.hpp"
#include "services/glove/devices/emulation.hpp"

namespace prehend::glove::testing {

/// An address of this machine whose port the kernel gave: for a device that opens it at once.
inline std::string free_address() {
  const int probe = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  EXPECT_EQ(::bind(probe, reinterpret_cast<const sockaddr*>(&address), size), 0);
  EXPECT_EQ(::getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size), 0);
  ::close(probe);
  return "127.0.0.1:" + std::to_string(ntohs(address.sin_port));
}

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
                  said_at_.push_back(std::chrono::steady_clock::now());
                  news_.notify_all();
                },
            .drop =
                [this](std::string_view reason, std::uint64_t count) {
                  const std::lock_guard lock(mutex_);
                  drops_[std::string(reason)] += count;
                }};
  }
  /// Waits for that many more frames.
  bool frames(std::size_t count, double patience = 10) {
    std::unique_lock lock(mutex_);
    const std::size_t wanted = frames_.size() + count;
    return news_.wait_for(lock, seconds(patience), [&] { return frames_.size() >= wanted; });
  }
  /// Waits for a frame of which this is true.
  bool frame_with(const std::function<bool(const Frame&)>& condition, double patience = 10) {
    std::unique_lock lock(mutex_);
    return news_.wait_for(lock, seconds(patience),
                          [&] { return std::any_of(frames_.begin(), frames_.end(), condition); });
  }
  bool says(const std::string& text, double patience = 10) {
    std::unique_lock lock(mutex_);
    return news_.wait_for(lock, seconds(patience), [&] {
      return std::any_of(lines_.begin(), lines_.end(), [&](const std::string& line) {
        return line.find(text) != std::string::npos;
      });
    });
  }
  /// Whatever it is, but not before that.
  bool complains_after(std::chrono::steady_clock::time_point time, double patience = 10) {
    std::unique_lock lock(mutex_);
    return news_.wait_for(lock, seconds(patience),
                          [&] { return !said_at_.empty() && said_at_.back() > time; });
  }
  std::vector<Frame> all() {
    const std::lock_guard lock(mutex_);
    return frames_;
  }
  std::map<std::string, std::uint64_t> drops() {
    const std::lock_guard lock(mutex_);
    return drops_;
  }
  std::vector<std::string> lines() {
    const std::lock_guard lock(mutex_);
    return lines_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable news_;
  std::vector<Frame> frames_;
  std::vector<std::string> lines_;
  std::vector<std::chrono::steady_clock::time_point> said_at_;  // of each line
  std::map<std::string, std::uint64_t> drops_;
};

/// A hand that does not move: always the same frame, every 10 ms.
class StillHand final : public FrameSource {
 public:
  explicit StillHand(Frame frame) : frame_(std::move(frame)) {}
  std::optional<Frame> frame(std::uint64_t n) const override {
    Frame frame = frame_;
    frame.sequence = n;
    frame.stamp = Time(std::chrono::milliseconds(10 * n));
    return frame;
  }

 private:
  Frame frame_;
};

/// Runs an emulated device from construction to destruction.
class EmulatedDevice {
 public:
  /// Waits until it is plugged in.
  EmulatedDevice(EmulationOptions options, const FrameSource& source) {
    std::promise<void> plugged;
    options.on_plugged = [&plugged, first = true](const std::string&) mutable {
      if (std::exchange(first, false)) plugged.set_value();
    };
    thread_ = std::thread([this, options = std::move(options), &source] {
      const auto done = emulate(options, source, [this] { return stop_.load(); });
      EXPECT_TRUE(done) << done.error().message();
    });
    plugged.get_future().wait();
  }
  ~EmulatedDevice() {
    stop_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace prehend::glove::testing
