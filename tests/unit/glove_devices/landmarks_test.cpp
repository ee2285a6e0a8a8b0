// The landmarks device on a socket of this machine: all five fingertips, either hand, and what
// hand trackers get wrong refused and counted by reason.
#include <gtest/gtest.h>
#include <unistd.h>

#include "common/base/clock.hpp"
#include "services/glove/devices/datagrams.hpp"
#include "services/glove/devices/landmark_line.hpp"
#include "services/glove/devices/paced.hpp"
#include "tests/unit/glove_devices/listener.hpp"

namespace prehend::glove {
namespace {

using Eigen::Vector3d;
using testing::free_address;
using testing::Listener;

/// A hand in the room, bent so much, at x.
Landmarks hand_at(double x, double closure) {
  const Pose X_TH = make_pose(
      {x, -0.4, 0.2}, Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vector3d(1, 2, 3).normalized())));
  Landmarks points =
      landmarks_of(model::HumanHand(1),
                   model::HumanHand::posture({closure, closure, closure, closure, closure}));
  for (auto& point : points) point = X_TH * point;
  return points;
}

class LandmarksTest : public ::testing::Test {
 protected:
  void start(bool left = false, const std::string& token = {}) {
    DeviceOptions options;
    options.left = left;
    options.token = token;
    options.scene.X_WH = make_pose({0.3, 0.1, 0.25});
    options.port = free_address();
    auto made = find_device("landmarks")->create(options);
    ASSERT_TRUE(made) << made.error().message();
    device_ = std::move(*made);
    device_->start(listener_.sink());
    port_ = options.port;
    sender_.emplace(*DatagramSender::create(options.port, token));
    // Until it listens: what nobody hears is lost.
    for (int n = 0; listener_.all().empty(); ++n) {
      ASSERT_LT(n, 500) << "no frame comes";
      Landmarks points = hand_at(0.001 * n, 0.5);
      if (left)
        for (auto& point : points) point.x() = -point.x();
      send({.left = left, .in_room = true, .points = points});
      listener_.frames(1, 0.02);
    }
  }
  void send(const LandmarkLine& line) { sender_->write(to_line(line) + "\n"); }
  double now() { return to_seconds(process_now().time_since_epoch()); }
  /// Sent again and again until it has been counted.
  bool refused(const std::string& reason, const std::string& text) {
    for (int n = 0; n < 500; ++n) {
      sender_->write(text);
      if (listener_.drops()[reason] > 0) return true;
      ::usleep(5000);
    }
    return false;
  }

  Listener listener_;
  std::string port_;
  std::unique_ptr<Device> device_;
  std::optional<DatagramSender> sender_;
};

TEST_F(LandmarksTest, GivesTheBackOfTheHandAndFiveFingertips) {
  start();
  const double stamp = now();
  const Landmarks points = hand_at(0.1, 0.4);
  send({.stamp = stamp, .in_room = true, .points = points});
  ASSERT_TRUE(listener_.frame_with([&](const Frame& f) {
    return std::abs(to_seconds(f.stamp.time_since_epoch()) - stamp) < 1e-6;
  })) << "the sender's own stamp";
  const Frame frame = listener_.all().back();
  ASSERT_EQ(frame.readings.size(), 6u);
  for (std::size_t f = 0; f < 5; ++f) {
    EXPECT_EQ(frame.readings[f + 1].site, static_cast<Site>(f + 1));
    EXPECT_LT((frame.readings[f + 1].p_TS - points[4 * f + 4]).norm(), 1e-9);
  }
  // H from landmarks leans by the slope from the wrist to the knuckle, 4 degrees, and by that of
  // the knuckles' row.
  EXPECT_LT((frame.readings[0].p_TS - Vector3d(0.1, -0.4, 0.2)).norm(), 0.02);
  EXPECT_FALSE(frame.left);
}

TEST_F(LandmarksTest, HoldsAWebcamsHandWhereTheSceneHasIt) {
  start();
  Landmarks points = hand_at(0, 0.4);
  for (auto& point : points) point = Vector3d(-point.y(), point.x(), point.z() + 1);
  send({.stamp = now(), .in_room = false, .points = points});
  ASSERT_TRUE(listener_.frame_with([&](const Frame& f) {
    return (f.readings[0].p_TS - Vector3d(0.3, 0.1, 0.25)).norm() < 1e-9;
  }));
}

// A left hand is the mirror image of a right one: mirrored landmarks give the same frame but for
// the mirror through the table's x.
TEST_F(LandmarksTest, MirrorsALeftHand) {
  start(true);
  Landmarks points = hand_at(0.1, 0.4);
  for (auto& point : points) point.x() = -point.x();
  send({.stamp = now(), .left = true, .in_room = true, .points = points});
  ASSERT_TRUE(listener_.frame_with([&](const Frame& f) {
    return f.left && (f.readings[1].p_TS - hand_at(0.1, 0.4)[4]).norm() < 1e-9;
  }));
  send({.stamp = now(), .in_room = true, .points = hand_at(0.1, 0.4)});
  EXPECT_TRUE(refused("other hand", to_line({.in_room = true, .points = hand_at(0.1, 0.4)})));
}

TEST_F(LandmarksTest, RefusesAndCountsWhatTrackersGetWrong) {
  start();
  const auto line = [&](double age, double x) {
    return to_line({.stamp = now() - age, .in_room = true, .points = hand_at(x, 0.5)});
  };
  const std::string good = line(0, 0.2);
  EXPECT_TRUE(refused("repeated", good)) << "the same again and again";
  EXPECT_TRUE(refused("stale", line(1, 0)));
  EXPECT_TRUE(refused("from the future", line(-10, 0)));
  const double stamp = now();
  send({.stamp = stamp, .in_room = true, .points = hand_at(0.1, 0.5)});
  EXPECT_TRUE(refused("second hand",
                      to_line({.stamp = stamp, .in_room = true, .points = hand_at(-0.2, 0.5)})));
  send({.stamp = now(), .in_room = true, .points = hand_at(0.1, 0.5)});
  EXPECT_TRUE(refused("out of order", line(0.2, 0)));
  EXPECT_TRUE(
      refused("wrong count", R"({"version":1,"hand":"right","origin":"room","points_m":[]})"));
  EXPECT_TRUE(refused("unreadable", "hello"));
  EXPECT_TRUE(refused("unreadable", std::string("\xff\xfe\x00\x80", 4)));
  Landmarks lost;
  lost.fill(Vector3d(0.1, 0, 0));
  EXPECT_TRUE(refused("all points in one place", to_line({.in_room = true, .points = lost})));
  // After all that a good line is a frame.
  const std::size_t before = listener_.all().size();
  send({.stamp = now(), .in_room = true, .points = hand_at(0.3, 0.5)});
  EXPECT_TRUE(listener_.frame_with(
      [&](const Frame& f) { return (f.readings[1].p_TS - hand_at(0.3, 0.5)[4]).norm() < 1e-9; }));
  EXPECT_GT(listener_.all().size(), before);
}

// Guards the robot against a hand that is not there: frozen with new stamps, mirrored, without a
// palm. None of them leads, and the status says which it is while datagrams come.
TEST_F(LandmarksTest, AHandThatIsNotThereLeadsNothing) {
  start();
  const Landmarks good = hand_at(0.2, 0.5);
  send({.stamp = now(), .in_room = true, .points = good});
  ASSERT_TRUE(listener_.frame_with(
      [&](const Frame& f) { return (f.readings[1].p_TS - good[4]).norm() < 1e-9; }));
  const std::size_t before = listener_.all().size();
  Landmarks mirrored = good, collapsed = good, trembling = good;
  for (auto& point : mirrored) point.y() = -0.8 - point.y();
  collapsed[17] = collapsed[5];
  const auto sent = [&](const Landmarks& points, const std::string& reason) {
    for (int n = 0; n < 20; ++n) {
      send({.stamp = now(), .in_room = true, .points = points});
      ::usleep(2000);
    }
    return refused(reason, to_line({.stamp = now(), .in_room = true, .points = points}));
  };
  EXPECT_TRUE(sent(good, "frozen"));
  EXPECT_TRUE(sent(mirrored, "a mirrored hand"));
  EXPECT_TRUE(sent(collapsed, "a collapsed palm"));
  EXPECT_EQ(listener_.all().size(), before);
  // A living hand that keeps still trembles.
  trembling[8] += Vector3d(1e-5, 0, 0);
  send({.stamp = now(), .in_room = true, .points = trembling});
  EXPECT_TRUE(listener_.frame_with(
      [&](const Frame& f) { return (f.readings[2].p_TS - trembling[8]).norm() < 1e-9; }));
}

TEST_F(LandmarksTest, SaysWhyDatagramsThatComeCannotBeUsed) {
  start();
  Landmarks points = hand_at(0.2, 0.5);
  for (auto& point : points) point *= 1000;
  const std::string wrong = to_line({.in_room = true, .points = points});
  bool told = false;
  for (int n = 0; n < 1000 && !told; ++n) {
    sender_->write(wrong);
    ::usleep(5000);
    for (const std::string& line : listener_.lines())
      told = told || (line.find("in millimetres") != std::string::npos &&
                      line.find("divide by 1000") != std::string::npos);
  }
  EXPECT_TRUE(told);
}

// With a token, only those who know it lead the hand; the others are counted.
TEST_F(LandmarksTest, WithATokenItHearsOnlyThoseWhoKnowIt) {
  const std::string token = "correct-horse-battery";
  start(false, token);  // gets a frame with the token
  const auto line = [&](double x) {
    return to_line({.stamp = now(), .in_room = true, .points = hand_at(x, 0.5)}) + "\n";
  };
  sender_.emplace(*DatagramSender::create(port_));  // without it
  for (const std::string& before :
       {std::string(), std::string("\n"), token.substr(1) + "\n", token + "x\n", token}) {
    const auto wrong = listener_.drops()["wrong token"];
    for (int n = 0; n < 500 && listener_.drops()["wrong token"] == wrong; ++n) {
      sender_->write(before + line(0.3));
      ::usleep(5000);
    }
    EXPECT_GT(listener_.drops()["wrong token"], wrong) << before;
  }
  for (const Frame& frame : listener_.all())
    EXPECT_GT((frame.readings[1].p_TS - hand_at(0.3, 0.5)[4]).norm(), 0.1) << "was led";
  sender_->write(token + "\n" + line(0.2));
  EXPECT_TRUE(listener_.frame_with(
      [&](const Frame& f) { return (f.readings[1].p_TS - hand_at(0.2, 0.5)[4]).norm() < 1e-9; }));
}

// Loopback is 127.0.0.0/8: an address of it stands for a host that is not in the list.
TEST(Datagrams, OnlyKnownSendersAreHeard) {
  const auto answer = [](std::vector<std::string> senders) {
    const std::string address = free_address();
    auto receiver = DatagramReceiver::bind({.address = address, .senders = senders, .token = {}});
    if (!receiver) return receiver.error().message();
    DatagramSender::create(address)->write("hello");
    const auto came = receiver->read(seconds(10));
    return came ? came->bytes + std::string(came->refused) : came.error().message();
  };
  EXPECT_EQ(answer({}), "hello") << "this machine, unless told otherwise";
  EXPECT_EQ(answer({"127.0.0.1"}), "hello");
  EXPECT_EQ(answer({"192.168.7.2", "127.0.0.1"}), "hello");
  EXPECT_EQ(answer({"192.168.7.2"}), "unknown sender");
  EXPECT_EQ(answer({"127.0.0.2"}), "unknown sender");
}

// Nothing else asks a sender who it is: with keys, a port for other hosts is opened only to those
// who are named and know the token.
TEST(Datagrams, ALabWithKeysOpensNoPortForEverybody) {
  ReceiverOptions open{.address = "0.0.0.0:9871", .senders = {}, .token = {}, .secured = true};
  EXPECT_FALSE(DatagramReceiver::check(open));
  open.senders = {"192.168.7.2"};
  EXPECT_FALSE(DatagramReceiver::check(open));
  open.token = "correct-horse-battery";
  EXPECT_TRUE(DatagramReceiver::check(open));
  open.senders = {};
  EXPECT_FALSE(DatagramReceiver::check(open));
  EXPECT_TRUE(DatagramReceiver::check(
      {.address = "127.0.0.1:9871", .senders = {}, .token = {}, .secured = true}));
  EXPECT_TRUE(DatagramReceiver::check({.address = "0.0.0.0:9871", .senders = {}, .token = {}}));
  EXPECT_FALSE(
      DatagramReceiver::check({.address = "127.0.0.1:9871", .senders = {"anna"}, .token = {}}));
  DeviceOptions options;
  options.port = "0.0.0.0:9871";
  options.secured = true;
  EXPECT_FALSE(find_device("landmarks")->create(options));
}

TEST(Landmarks, RefusesAWrongAddress) {
  for (const char* wrong : {"9870", "here:9870", "127.0.0.1:", "127.0.0.1:99999", "127.0.0.1:0"}) {
    DeviceOptions options;
    options.port = wrong;
    EXPECT_FALSE(find_device("landmarks")->create(options)) << wrong;
  }
  EXPECT_TRUE(find_device("landmarks")->create({})) << "on this machine, unless told otherwise";
}

}  // namespace
}  // namespace prehend::glove
