// What holds for every device in the registry: its frames are finite and within its reach,
// rotations orthonormal, stamps strictly increasing and close to their arrival; no fault of a line
// ends it; it comes back by itself. A new row is tested without a word here, and fails without an
// emulator.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <set>

#include "common/base/clock.hpp"
#include "common/service/config.hpp"
#include "services/glove/devices/paced.hpp"
#include "tests/support/domains/domain_lease.hpp"
#include "tests/unit/glove_devices/listener.hpp"

namespace prehend::glove {
namespace {

using Clock = std::chrono::steady_clock;
using Eigen::Vector3d;
using testing::EmulatedDevice;
using testing::free_address;
using testing::Listener;

/// A hand that opens and closes twice a second and moves 10 cm to and fro, with five fingertips and
/// all joints, 100 frames a second.
class WavingHand final : public FrameSource {
 public:
  std::optional<Frame> frame(std::uint64_t n) const override {
    const double t = 0.01 * static_cast<double>(n);
    const double wave = std::sin(4 * std::numbers::pi * t);
    std::array<double, model::finger_count> closure;
    closure.fill(0.4 + 0.3 * wave);
    const model::HumanPosture posture = model::HumanHand::posture(closure);
    const Pose X_TH = make_pose(Vector3d(0.05 * wave, -0.45, 0.2),
                                Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Vector3d::UnitX())));
    Frame frame;
    frame.sequence = n;
    frame.stamp = Time(seconds(t));
    frame.readings.push_back(
        {Site::back_of_hand, true, X_TH.translation(), Eigen::Quaterniond(X_TH.linear())});
    const auto tips = model::HumanHand(1).fingertip_poses(posture);
    for (std::size_t f = 0; f < tips.size(); ++f) {
      const Pose X_TF = X_TH * tips[f];
      frame.readings.push_back(
          {static_cast<Site>(f + 1), true, X_TF.translation(), Eigen::Quaterniond(X_TF.linear())});
    }
    frame.joint_angles.assign(posture.begin(), posture.end());
    return frame;
  }
};

class EveryDevice : public ::testing::TestWithParam<DeviceKind> {
 protected:
  EveryDevice() {
    const auto file =
        "prehend_device_" + std::to_string(::getpid()) + "_" + std::string(GetParam().name);
    options_.port = GetParam().line == Line::datagrams ? free_address()
                    : GetParam().line == Line::nodes
                        ? file
                        : (std::filesystem::temp_directory_path() / file).string();
    ::setenv("ROS_DOMAIN_ID", std::to_string(nodes_.domain()).c_str(), 1);
    options_.rate = 50;
    options_.scene.X_WH = make_pose({0, 0, 0.25});
    options_.file = std::filesystem::temp_directory_path() / (file + ".csv");
  }

  std::unique_ptr<Device> device() const {
    auto made = GetParam().create(options_);
    EXPECT_TRUE(made) << made.error().message();
    return std::move(*made);
  }
  std::unique_ptr<EmulatedDevice> emulator(const FaultOptions& faults = {}) const {
    EmulationOptions emulation = emulation_of(GetParam(), options_, options_.port);
    emulation.rate = 50;
    emulation.faults = faults;
    return std::make_unique<EmulatedDevice>(std::move(emulation), source_);
  }
  bool has_line() const { return GetParam().has_port(); }
  /// Before its driver, at whose end it must not speak: Fast DDS 2.9.1 hands over within a process
  /// by pointers, and ends it when a reader leaves meanwhile (common/dds/guard/within_process.hpp).
  /// They are two processes elsewhere.
  static void silence(std::unique_ptr<EmulatedDevice>& emulated) { emulated.reset(); }

  /// Calls with s from the start at which something is to happen to a device that has spoken; later
  /// ones, as long as it did so too late, since it waited for a processor.
  template <class Attempt>
  static void after_first_frames(Attempt attempt) {
    for (const double at : {2.5, 5.0, 10.0, 20.0})
      if (attempt(at) || HasFailure()) return;
    FAIL() << "it does not begin to speak";
  }
  static bool passed(Clock::time_point start, double at) {
    return to_seconds(Clock::now() - start) > at - 0.2;
  }

  /// Of all frames so far. Arrivals were before now.
  static void expect_sound(const std::vector<Frame>& frames) {
    for (std::size_t n = 0; n < frames.size(); ++n) {
      const Frame& frame = frames[n];
      if (n > 0) {
        ASSERT_GT(frame.stamp, frames[n - 1].stamp);
        ASSERT_EQ(frame.sequence, frames[n - 1].sequence + 1);
      }
      ASSERT_LE(frame.stamp, process_now() + std::chrono::milliseconds(1));
      std::set<Site> sites;
      for (const Reading& reading : frame.readings) {
        ASSERT_TRUE(sites.insert(reading.site).second) << "a site twice";
        if (!reading.valid) continue;
        ASSERT_TRUE(reading.p_TS.allFinite());
        ASSERT_LE(reading.p_TS.cwiseAbs().maxCoeff(), 5);
        const Eigen::Matrix3d R = reading.q_TS.toRotationMatrix();
        ASSERT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-6);
      }
      ASSERT_TRUE(sites.contains(Site::back_of_hand));
      if (frame.joint_angles.empty()) continue;
      ASSERT_EQ(frame.joint_angles.size(), 20u);
      const model::HumanPosture q =
          Eigen::Map<const model::HumanPosture>(frame.joint_angles.data());
      ASSERT_TRUE(q.allFinite());
      ASSERT_EQ(q, model::HumanHand(1).clamp(q)) << "beyond what a hand can do";
    }
  }

  const test::DomainLease nodes_;
  DeviceOptions options_;
  WavingHand source_;
};

TEST_P(EveryDevice, SaysAllThatOthersAsk) {
  const DeviceKind& kind = GetParam();
  EXPECT_TRUE(kind.create);
  EXPECT_FALSE(kind.help.empty());
  EXPECT_EQ(kind.emulate != nullptr, kind.has_port()) << "what has a port needs an emulator";
  EXPECT_FALSE(kind.source && kind.has_port()) << "a hand that has a port is no source";
  EXPECT_EQ(!kind.address.empty(), kind.line == Line::datagrams);
  EXPECT_TRUE(!kind.synthetic || kind.source) << "a computed hand can move emulated devices";
  EXPECT_EQ(line_names.value(line_names.name(kind.line)), kind.line);
}

// A misspelt key would be refused in lab.toml; what has a port is told where.
TEST_P(EveryDevice, ReadsKeysThatThereAre) {
  std::set<std::string_view> known;
  for (const service::ConfigKey& key : service::config_keys()) known.insert(key.name);
  std::set<std::string_view> named;
  for (const std::string_view key : GetParam().keys) {
    EXPECT_TRUE(known.contains(key)) << key;
    EXPECT_TRUE(named.insert(key).second) << key << " twice";
  }
  EXPECT_EQ(named.contains("glove.port"), GetParam().has_port());
  EXPECT_EQ(named.contains("glove.file"), GetParam().line == Line::file);
  EXPECT_EQ(named.contains("glove.wrist_port"), !GetParam().tracker.empty());
}

TEST_P(EveryDevice, IsFoundByItsNameAlone) {
  const auto found = find_device(GetParam().name);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->create, GetParam().create);
  if (GetParam().tracker.empty()) return;
  const auto tracker = find_device(GetParam().tracker);
  ASSERT_TRUE(tracker) << "sits on its back";
  EXPECT_TRUE(tracker->has_port());
  EXPECT_TRUE(tracker->tracker.empty()) << "tracks by itself";
}

// What a lab has that names none, what it has in lockstep, what `prehend demo` plays on.
TEST(Devices, ThereIsOneForEachUse) {
  EXPECT_EQ(find_device("")->name, device_kinds().front().name);
  EXPECT_EQ(topic_device().line, Line::topic);
  const auto has = [](auto&& what) {
    return std::any_of(device_kinds().begin(), device_kinds().end(), what);
  };
  EXPECT_TRUE(has([](const DeviceKind& kind) { return kind.emulate != nullptr; }));
  EXPECT_TRUE(has([](const DeviceKind& kind) { return kind.source && kind.line == Line::none; }));
  const auto none = find_device("mind reader");
  ASSERT_FALSE(none);
  for (const DeviceKind& kind : device_kinds())
    EXPECT_NE(none.error().hint.find(kind.name), std::string::npos) << kind.name;
}

// Nothing is wrong, so nothing is dropped; and no frame is stamped before it can have been
// measured.
TEST_P(EveryDevice, GivesSoundFrames) {
  if (GetParam().line == Line::topic) return;
  if (GetParam().line == Line::file) return;  // recording_test.cpp reads its files
  auto emulated = has_line() ? emulator() : nullptr;
  Listener listener;
  const auto driver = device();
  driver->start(listener.sink());
  ASSERT_TRUE(listener.frames(100));
  silence(emulated);
  const auto frames = listener.all();
  expect_sound(frames);
  if (!has_line()) return;
  EXPECT_GT(to_seconds(frames.back().stamp - frames.front().stamp),
            static_cast<double>(frames.size() - 1) / 50 - 0.2);
  EXPECT_TRUE(listener.drops().empty());
}

TEST_P(EveryDevice, SurvivesEveryFault) {
  if (!has_line()) return;
  const std::pair<const char*, FaultOptions> faults[] = {
      {"noise and extreme points", {.noise = 0.0015, .extreme = 0.1}},
      {"garbage", {.garbage = 0.2}},
      {"dropped bytes", {.drop_bytes = 0.2}},
      {"swapped bytes", {.swap_bytes = 0.2}},
      {"all at once",
       {.noise = 0.01, .extreme = 0.05, .garbage = 0.05, .drop_bytes = 0.05, .swap_bytes = 0.05}}};
  for (const auto& [name, fault] : faults) {
    SCOPED_TRACE(name);
    auto emulated = emulator(fault);
    Listener listener;
    const auto driver = device();
    driver->start(listener.sink());
    ASSERT_TRUE(listener.frames(30, 20));
    silence(emulated);
    expect_sound(listener.all());
    if (fault.drop_bytes > 0.1 || fault.garbage > 0.1) {
      EXPECT_FALSE(listener.drops().empty()) << "lost bytes are counted";
    }
  }
}

// Without power, too: it begins as when it was switched on.
TEST_P(EveryDevice, ComesBackWithin2500MillisecondsOfReplugging) {
  if (!has_line()) return;
  constexpr double unplug_for = 1, aim = 2.5;
  after_first_frames([&](double unplug_at) {
    const auto start = Clock::now();
    auto emulated = emulator({.unplug_at = unplug_at, .unplug_for = unplug_for});
    Listener listener;
    const auto driver = device();
    driver->start(listener.sink());
    if (!listener.frames(5) || passed(start, unplug_at)) return false;
    // Before that it may complain because it has to wait for a processor.
    const auto unplugged = start + std::chrono::duration_cast<Clock::duration>(seconds(unplug_at));
    EXPECT_TRUE(listener.complains_after(unplugged)) << "says nothing";
    EXPECT_TRUE(listener.frames(1));
    const double after = to_seconds(Clock::now() - start) - unplug_at - unplug_for;
    EXPECT_LT(after, aim);
    std::cout << GetParam().name << ": frames " << after << " s after replugging\n";
    EXPECT_TRUE(listener.frames(20));
    silence(emulated);
    expect_sound(listener.all());
    return true;
  });
}

TEST_P(EveryDevice, SaysWhenItFallsSilentAndComesBack) {
  if (!has_line()) return;
  after_first_frames([&](double silent_at) {
    const auto start = Clock::now();
    auto emulated = emulator({.silent_at = silent_at, .silent_for = 1});
    Listener listener;
    const auto driver = device();
    driver->start(listener.sink());
    if (!listener.frames(5) || passed(start, silent_at)) return false;
    EXPECT_TRUE(listener.says(GetParam().line == Line::serial ? "silent" : "no landmarks"));
    EXPECT_TRUE(listener.frames(20));
    silence(emulated);
    expect_sound(listener.all());
    return true;
  });
}

TEST_P(EveryDevice, EndsAtOnce) {
  if (GetParam().line == Line::topic || GetParam().line == Line::file) return;
  Listener listener;
  auto driver = device();
  driver->start(listener.sink());
  const auto start = Clock::now();
  driver.reset();
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(2));
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryDevice, ::testing::ValuesIn(device_kinds()),
                         [](const auto& row) { return std::string(row.param.name); });

}  // namespace
}  // namespace prehend::glove
