// The serial driver against the emulated tracker on a real pseudo-terminal: start, formats, faults,
// silence, a port that goes and returns. Times are generous for a busy machine; the driver's own
// waits are 1.2 s for auto-configure.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "common/serial/pseudo_terminal.hpp"
#include "services/glove/devices/bird_emulator.hpp"
#include "tests/unit/glove_devices/listener.hpp"

namespace prehend::glove {
namespace {

using Clock = std::chrono::steady_clock;
using Eigen::Vector3d;
using testing::Listener;

double since(Clock::time_point start) {
  return to_seconds(std::chrono::duration_cast<Duration>(Clock::now() - start));
}

Frame still_hand() {
  Frame frame;
  for (std::size_t s = 0; s < 4; ++s)
    frame.readings.push_back(
        {usual_sites()[s], true, Vector3d(0.1 + 0.1 * static_cast<double>(s), -0.2, 0.9),
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
  explicit Tracker(const std::filesystem::path& link, const FaultOptions& faults = {},
                   bird::EmulatorOptions options = {}, double rate = 100,
                   std::vector<std::uint8_t> held = {})
      : hand_(with_buttons(std::move(held))),
        device_(line(link, faults, std::move(options), rate), hand_) {}

 private:
  static Frame with_buttons(std::vector<std::uint8_t> held) {
    Frame frame = still_hand();
    frame.held = std::move(held);
    return frame;
  }
  static EmulationOptions line(const std::filesystem::path& link, const FaultOptions& faults,
                               bird::EmulatorOptions options, double rate) {
    return {.device = [options] { return std::make_unique<bird::Emulator>(options); },
            .plug_in = [link]() -> Expected<std::unique_ptr<serial::Plug>> {
              auto terminal = serial::PseudoTerminal::open(link);
              if (!terminal) return tl::unexpected(terminal.error());
              return std::make_unique<serial::PseudoTerminal>(std::move(*terminal));
            },
            .rate = rate,
            .baud = 115200,
            .faults = faults};
  }
  testing::StillHand hand_;
  testing::EmulatedDevice device_;
};

std::unique_ptr<Device> make(const DeviceOptions& options) {
  auto device = find_device("nest_of_birds")->create(options);
  EXPECT_TRUE(device) << device.error().message();
  return std::move(*device);
}

std::unique_ptr<Device> driver(const std::filesystem::path& port,
                               const std::string& format = "position_matrix") {
  DeviceOptions options;
  options.port = port;
  options.format = format;
  return make(options);
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
    EXPECT_LT(since(start), cold ? 2.5 : 1.0) << format;
    cold = false;
    ASSERT_TRUE(listener.frames(10)) << format;
    const auto frames = listener.all();
    for (std::size_t n = 1; n < frames.size(); ++n) {
      EXPECT_EQ(frames[n].sequence, frames[n - 1].sequence + 1);
      EXPECT_GT(frames[n].stamp, frames[n - 1].stamp);
    }
    expect_still_hand(frames.back());
    EXPECT_TRUE(listener.lines().empty());
  }
}

// Whose frames say that their left hand was mirrored: the sensors are where the left one has them,
// and the glove mirrors them again.
TEST(NestOfBirds, ALeftHandWearsItsEmulator) {
  Frame right = still_hand();
  right.left = true;
  const testing::StillHand hand(right);
  DeviceOptions options;
  options.port = link_path("left");
  options.X_WT =
      make_pose({0.1, 0.4, 0.3}, Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Vector3d::UnitZ())));
  const EmulationOptions line = emulation_of(*find_device("nest_of_birds"), options, options.port);
  const testing::EmulatedDevice tracker(line, hand);
  Listener listener;
  const auto device = make(options);
  device->start(listener.sink());
  ASSERT_TRUE(listener.frames(1));
  const Frame raw = listener.all().back();
  EXPECT_FALSE(raw.left);
  EXPECT_GT((raw.readings[0].p_TS - right.readings[0].p_TS).norm(), 0.1);
  expect_still_hand(mirrored(raw, left_to_right(options.X_WT)));
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
  EXPECT_LE(listener.lines().size(), 4u) << "one line for a state, not one for a try";
}

TEST(NestOfBirds, StartsASilentTrackerAgain) {
  const auto link = link_path("mute");
  const Tracker tracker(link, {.silent_at = 2, .silent_for = 1});
  Listener listener;
  const auto device = driver(link);
  device->start(listener.sink());
  ASSERT_TRUE(listener.frames(5));
  EXPECT_TRUE(listener.says("silent"));
  EXPECT_TRUE(listener.frames(5));
}

TEST(NestOfBirds, AsksForEachFrameInPointMode) {
  const auto link = link_path("point");
  const Tracker tracker(link);
  Listener listener;
  DeviceOptions options;
  options.port = link;
  options.mode = "point";
  options.rate = 50;
  const auto device = make(options);
  device->start(listener.sink());
  ASSERT_TRUE(listener.frames(20));
  expect_still_hand(listener.all().back());
}

// Any number of sensors anywhere, also one that stands alone, whose records bear no address.
TEST(NestOfBirds, ReadsAsManySensorsAsThereAre) {
  const std::vector<std::vector<Site>> mountings{
      {Site::back_of_hand},
      {Site::forearm, Site::back_of_hand},
      {Site::ring, Site::middle, Site::back_of_hand, Site::thumb, Site::index, Site::little,
       Site::forearm}};
  for (const auto& sites : mountings) {
    const auto link = link_path("sites");
    const Tracker tracker(link, {}, {.sites = sites}, 30);
    Listener listener;
    DeviceOptions options;
    options.port = link;
    options.sites = sites;
    options.format = "position_quaternion";
    const auto device = make(options);
    device->start(listener.sink());
    ASSERT_TRUE(listener.frames(3)) << sites.size();
    const Frame frame = listener.all().back();
    ASSERT_EQ(frame.readings.size(), sites.size());
    for (const Reading& truth : still_hand().readings)
      for (std::size_t s = 0; s < sites.size(); ++s)
        if (truth.site == sites[s]) {
          EXPECT_EQ(frame.readings[s].site, sites[s]);
          EXPECT_LT((frame.readings[s].p_TS - truth.p_TS).norm(), 3e-4);
        }
  }
}

TEST(NestOfBirds, TellsWhichButtonOfTheMouseIsHeld) {
  for (const std::vector<std::uint8_t>& held :
       {std::vector<std::uint8_t>{}, std::vector<std::uint8_t>{2}, std::vector<std::uint8_t>{3}}) {
    const auto link = link_path("mouse");
    const Tracker tracker(link, {}, {}, 100, held);
    Listener listener;
    DeviceOptions options;
    options.port = link;
    options.buttons = true;
    const auto device = make(options);
    device->start(listener.sink());
    ASSERT_TRUE(listener.frames(3));
    const Frame frame = listener.all().back();
    expect_still_hand(frame);
    ASSERT_TRUE(frame.held);
    EXPECT_EQ(*frame.held, held);
  }
}

TEST(NestOfBirds, WithoutAMouseNoButtonIsTold) {
  const auto link = link_path("no_mouse");
  const Tracker tracker(link, {}, {}, 100, {1});
  Listener listener;
  const auto device = driver(link);
  device->start(listener.sink());
  ASSERT_TRUE(listener.frames(3));
  EXPECT_FALSE(listener.all().back().held);
}

TEST(NestOfBirds, SetsRangeAndHemisphereOfEveryUnit) {
  for (const auto& [range, hemisphere] :
       {std::pair(36, "front"), std::pair(72, "lower"), std::pair(144, "left")}) {
    const auto link = link_path("range");
    const Tracker tracker(link, {}, {.extended = range == 144});
    Listener listener;
    DeviceOptions options;
    options.port = link;
    options.range = range;
    options.hemisphere = hemisphere;
    const auto device = make(options);
    device->start(listener.sink());
    ASSERT_TRUE(listener.frames(1)) << range << hemisphere;
    // Half a step of 14 bits at that range in each coordinate. z is 0.9 m, just within 36 inches.
    for (std::size_t s = 0; s < 4; ++s)
      EXPECT_LT((listener.all()[0].readings[s].p_TS - still_hand().readings[s].p_TS).norm(),
                3e-4 * range / 72)
          << range << hemisphere;
  }
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
  options.sites = {};
  EXPECT_FALSE(kind->create(options));
  options.sites = usual_sites();
  options.hemisphere = "there";
  EXPECT_FALSE(kind->create(options));
  options.hemisphere = "left";
  options.range = 100;
  EXPECT_FALSE(kind->create(options));
  options.range = 72;
  options.mode = "guess";
  EXPECT_FALSE(kind->create(options));
  options.mode = "point";
  options.baud = 300;
  EXPECT_EQ(kind->create(options).error().message(),
            "glove.baud: the tracker knows 2400 to 115200 bits per second");
  options.rate = 0;
  EXPECT_EQ(kind->create(options).error().message(), "glove.rate: the rate must be 1 to 1000 Hz");
  EXPECT_FALSE(find_device("mind reader"));
}

}  // namespace
}  // namespace prehend::glove
