// A glove that holds fingers back, over a pseudo-terminal: a finger stops where it is when the
// robot's presses, opens when it likes, and is let go when nobody says any more what is felt.
#include "services/glove/devices/open_glove.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "common/base/clock.hpp"
#include "common/serial/pseudo_terminal.hpp"
#include "services/glove/devices/open_glove_line.hpp"
#include "services/glove/devices/paced.hpp"
#include "tests/unit/glove_devices/listener.hpp"

namespace prehend::glove {
namespace {

constexpr double full_force = 10;  // N
constexpr double closed = 0.95;    // of a finger

/// Fingers that close within a second, and stay so.
class ClosingHand final : public FrameSource {
 public:
  std::optional<Frame> frame(std::uint64_t n) const override {
    Frame frame;
    frame.sequence = n;
    frame.stamp = Time(seconds(0.01 * static_cast<double>(n)));
    std::array<double, model::finger_count> closure;
    closure.fill(std::min(1.0, 0.01 * static_cast<double>(n)));
    const model::HumanPosture posture = model::HumanHand::posture(closure);
    frame.joint_angles.assign(posture.begin(), posture.end());
    frame.readings.push_back(
        {Site::back_of_hand, true, Eigen::Vector3d(0, 0, 0.2), Eigen::Quaterniond::Identity()});
    return frame;
  }
};

class OpenGloveFeels : public ::testing::Test {
 protected:
  OpenGloveFeels() {
    options_.port = (std::filesystem::temp_directory_path() /
                     ("prehend_open_glove_" + std::to_string(::getpid())))
                        .string();
    options_.rate = 100;
    options_.feedback_force = full_force;
  }

  void start() {
    EmulationOptions emulation = emulation_of(*find_device("open_glove"), options_, options_.port);
    emulation.rate = options_.rate;
    emulator_ = std::make_unique<testing::EmulatedDevice>(std::move(emulation), source_);
    device_ = std::move(*create_open_glove(options_));
    DeviceSink sink = listener_.sink();
    sink.frame = [this, frame = sink.frame](Frame measured) {
      const auto closures = finger_closures(measured.joint_counts, *typical_gains(finger_sensors));
      index_ = closures[1];
      little_ = closures[4];
      feel();
      frame(std::move(measured));
    };
    sink.felt = [this](Time stamp) { felt_ = stamp; };
    device_->start(std::move(sink));
  }

  /// The robot's index finger presses with all that counts, as long as `presses_`.
  void feel() {
    if (!presses_) return;
    Feedback feedback{.stamp = process_now()};
    feedback.fingers[1] = {.force = full_force, .contact = true};
    device_->feel(feedback);
  }

  bool until(const std::function<bool()>& condition) {
    for (int n = 0; n < 1000 && !condition(); ++n)
      if (!listener_.frames(1)) break;
    return condition();
  }

  DeviceOptions options_;
  ClosingHand source_;
  testing::Listener listener_;
  std::atomic<double> index_ = 0, little_ = 0;  // how far they are closed
  std::atomic<bool> presses_ = true;
  std::atomic<Time> felt_{};
  std::unique_ptr<testing::EmulatedDevice> emulator_;
  std::unique_ptr<Device> device_;  // last: its thread ends before the rest goes
};

TEST_F(OpenGloveFeels, TheFingerThatFeelsIsHeldBackTheOthersAreNotAndAllAreLetGo) {
  start();
  ASSERT_TRUE(until([this] { return little_ > closed; })) << "nothing holds it";
  EXPECT_LT(index_, closed) << "it is pressed";
  EXPECT_NE(felt_.load(), Time{});
  presses_ = false;  // nobody says what is felt
  EXPECT_TRUE(until([this] { return index_ > closed; })) << "it is still held";
}

// Servos keep what they were told last.
TEST_F(OpenGloveFeels, AllAreLetGoAtTheEnd) {
  auto glove = std::move(*serial::PseudoTerminal::open(options_.port));
  device_ = std::move(*create_open_glove(options_));
  device_->start(listener_.sink());
  std::string told;
  for (int n = 0; n < 1000 && told.find("B1000") == std::string::npos; ++n) {
    Feedback feedback{.stamp = process_now()};
    feedback.fingers[1].force = full_force;
    device_->feel(feedback);
    glove.write("A0B0C0D0E0F2048G2048P0\n");
    told += glove.read(std::chrono::milliseconds(10));
  }
  ASSERT_NE(told.find("B1000"), std::string::npos);
  device_.reset();
  for (std::string more = "?"; !more.empty(); told += more)
    more = glove.read(std::chrono::milliseconds(50));
  EXPECT_TRUE(told.ends_with(open_glove::to_line(open_glove::HeldBack{}))) << told;
}

TEST(OpenGlove, NeedsAPort) {
  EXPECT_EQ(create_open_glove({}).error().message(),
            "glove.port: no port is named (name one such as /dev/ttyUSB0)");
}

/// Somebody who is not there.
class NoHand final : public FrameSource {
 public:
  std::optional<Frame> frame(std::uint64_t) const override { return std::nullopt; }
};

TEST(Emulation, NeedsAFrameToBeginWith) {
  EXPECT_EQ(emulate({}, NoHand(), [] { return true; }).error().message(),
            "emulator: the source has no frame (choose another)");
}

TEST_F(OpenGloveFeels, WhoWantsNoForceFeelsNone) {
  options_.feedback_force = 0;
  start();
  ASSERT_TRUE(listener_.frames(150));
  EXPECT_GT(index_, closed);
  EXPECT_EQ(felt_.load(), Time{});
}

}  // namespace
}  // namespace prehend::glove
