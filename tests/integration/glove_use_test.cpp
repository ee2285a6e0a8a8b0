// Using a glove, with real processes: what it sends wrong is counted by reason, a left hand is
// mirrored and says so, a user is calibrated, the tracker is registered, a person watches. The
// glove service takes its frames by topic from the test, which plays the person.
#include <gmock/gmock.h>

#include <atomic>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "common/convert/convert.hpp"
#include "common/dds/topics.hpp"
#include "common/service/config.hpp"
#include "services/glove/core/calibration/hand_fit.hpp"
#include "services/glove/devices/device.hpp"
#include "services/glove/devices/emulation.hpp"
#include "services/glove/files/user_file.hpp"
#include "tests/integration/rig.hpp"
#include "tests/integration/terminal.hpp"

namespace prehend::integration {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class GloveUse : public Rig {
 protected:
  v1::GloveFrame frame(const Pose& X_TH, const model::HumanPosture& q, double scale = 1) {
    v1::GloveFrame message;
    message.glove("glove");
    message.device("test");
    message.sequence_number(++frames_);
    message.stamp_ns(now_ns());
    const auto add = [&](v1::SensorSite site, const Pose& X_TS) {
      v1::SensorReading reading;
      reading.site(site);
      reading.valid(true);
      reading.X_TS(convert::to_message(X_TS));
      message.sensors().push_back(reading);
    };
    add(v1::SITE_BACK_OF_HAND, X_TH);
    const auto tips = model::HumanHand(scale).fingertip_poses(q);
    add(v1::SITE_THUMB, X_TH * tips[0]);
    add(v1::SITE_INDEX, X_TH * tips[1]);
    add(v1::SITE_LITTLE, X_TH * tips[4]);
    return message;
  }
  void publish(const v1::GloveFrame& message) {
    ASSERT_TRUE(writer_.write(message));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the glove's rate
  }
  const Pose place_ = make_pose(Vector3d(0.1, -0.2, 0.3));
  const model::HumanPosture half_ = model::HumanHand::posture({0.4, 0.4, 0.4, 0.4, 0.4});
  dds::Writer<v1::GloveFrame> writer_ = writer(dds::glove_frame);
  std::uint64_t frames_ = 0;
};

TEST_F(GloveUse, WhatIsWrongIsCountedByReason) {
  auto glove = start("glove", {"glove.device=topic"});
  auto statuses = reader(dds::service_status);
  auto postures = reader(dds::hand_posture);
  const std::vector<std::pair<std::string, std::function<void(v1::GloveFrame&)>>> faults{
      {"not finite", [](auto& f) { f.sensors()[0].X_TS().position().x(NAN); }},
      {"zero norm", [](auto& f) { f.sensors()[1].X_TS().orientation() = {}; }},
      {"identity pose",
       [](auto& f) { f.sensors()[2].X_TS(convert::to_message(Pose::Identity())); }},
      {"not valid", [](auto& f) { f.sensors()[3].valid(false); }},
      {"extreme point", [](auto& f) { f.sensors()[1].X_TS().position().z(0.6); }},
      {"second hand", [](auto& f) { f.sensors().push_back(f.sensors()[0]); }},
      {"no back of hand", [](auto& f) { f.sensors()[0].site(v1::SITE_FOREARM); }},
      {"stale", [](auto& f) { f.stamp_ns(f.stamp_ns() - 1'000'000'000); }},
      {"from the future", [](auto& f) { f.stamp_ns(f.stamp_ns() + 1'000'000'000); }},
      {"out of order", [](auto& f) { f.stamp_ns(f.stamp_ns() - 100'000'000); }},
      {"not the joints of a hand",
       [](auto& f) {
         f.joint_angles({0.1, 0.2});
       }},
      {"extreme angle", [](auto& f) { f.joint_angles(std::vector<double>(20, 4.0)); }},
  };
  std::set<std::string> missing;
  for (const auto& [reason, spoil] : faults) missing.insert(reason);
  std::size_t next = 0;
  const Vector3d tip = model::HumanHand(1).fingertip_poses(half_)[1].translation();
  double worst = 0;
  int heard = 0;
  EXPECT_TRUE(eventually(30, [&] {
    for (int n = 0; n < 8; ++n) publish(frame(place_, half_));
    v1::GloveFrame bad = frame(place_, half_);
    faults[next++ % faults.size()].second(bad);
    publish(bad);
    for (const auto& sample : postures.take()) {
      if (sample.info.gone || !sample.data.fingertips()[1].valid()) continue;
      ++heard;
      worst =
          std::max(worst, (convert::from_message(sample.data.fingertips()[1].p_HF()) - tip).norm());
    }
    for (const auto& sample : statuses.take())
      for (const v1::Drop& drop : sample.data.drops()) missing.erase(drop.reason().to_string());
    return missing.empty();
  })) << testing::PrintToString(missing);
  EXPECT_GE(heard, 10) << "one each round of nine frames";
  EXPECT_LT(worst, 1e-6) << "none of it moves a fingertip";
}

TEST_F(GloveUse, ALeftHandIsMirroredAndSaysSo) {
  const std::string port = (folder_ / "tracker").string();
  auto tracker = start_program("prehend-glove-tool", {"emulate", "--from", "synthetic", "--scene",
                                                      scene(1), "--link", port});
  ASSERT_TRUE(eventually(20, [&] { return std::filesystem::exists(port); }));
  auto frames = reader(dds::glove_frame);
  auto statuses = reader(dds::service_status);
  auto glove =
      start("glove", {"glove.device=nest_of_birds", "glove.port=" + port, "glove.hand=left"});
  EXPECT_TRUE(hear<v1::GloveFrame>(frames, 20, [](auto& f) { return f.left(); }));
  EXPECT_TRUE(hear<v1::ServiceStatus>(statuses, 20, [](auto& s) {
    return std::any_of(s.rates().begin(), s.rates().end(), [](const v1::Rate& rate) {
      return rate.name().to_string() == "frames of a left hand, mirrored" && rate.total() > 0;
    });
  }));
  EXPECT_THAT(text_of(glove.log()), HasSubstr("the left hand is mirrored"));
  EXPECT_EQ(run("prehend-glove", lab_arguments({"glove.hand=third"}), 20).exit_code, 2);
}

TEST_F(GloveUse, AUserIsCalibratedAndTheServiceKnowsTheHand) {
  constexpr double scale = 1.12;
  const std::string file = (folder_ / "users" / "anna.toml").string(),
                    recording = (folder_ / "session.mcap").string();
  stage::Process recorder =
      start_program("prehend-record", with_lab({"glove/frame", "--quiet", "-o", recording}));
  stage::Process tool =
      start_program("prehend-glove-tool",
                    with_lab({"calibrate", "--user", "anna", "--out", file, "--limit", "60"}));
  meet(writer_, 2);  // the recorder hears the person from the beginning
  for (const auto pose : glove::shown_poses) {
    const std::string next = pose == glove::ShownPose::pinch
                                 ? "hand scale"
                                 : std::string(glove::to_string(pose)) + " taken";
    EXPECT_TRUE(eventually(30, [&] {
      publish(frame(place_, glove::posture_of(pose), scale));
      return text_of(tool.log()).find(next) != std::string::npos;
    })) << next;
  }
  const auto ended = tool.wait(seconds(10));
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->code, 0);
  recorder.signal(SIGINT);
  ASSERT_TRUE(recorder.wait(seconds(10)));
  const auto user = glove::load_user(file);
  ASSERT_TRUE(user) << user.error().message();
  EXPECT_NEAR(user->scale, scale, 0.03);
  EXPECT_EQ(user->user, "anna");

  // The recording of it says the same, without anybody there.
  const Answer again = run("prehend-glove-tool",
                           {"calibrate", "--user", "anna", "--from", recording, "--out",
                            (folder_ / "again.toml").string(), "--json"},
                           30);
  ASSERT_EQ(again.exit_code, 0) << again.log;
  EXPECT_NEAR(nlohmann::json::parse(again.output)["hand_scale"].get<double>(), user->scale, 0.01);

  auto postures = reader(dds::hand_posture);
  auto service = start("glove", {"glove.device=topic", "glove.calibration=" + file});
  EXPECT_TRUE(eventually(20, [&] {
    publish(frame(place_, half_, scale));
    for (const auto& sample : postures.take())
      if (!sample.info.gone && sample.data.user().to_string() == "anna" &&
          std::abs(sample.data.hand_scale() - user->scale) < 1e-9)
        return true;
    return false;
  }));
  EXPECT_EQ(
      run("prehend-glove", lab_arguments({"glove.device=topic", "glove.calibration=/none"}), 20)
          .exit_code,
      3);
}

/// A person who shows the pose asked for, to an emulated glove.
class ShowingHand : public glove::FrameSource {
 public:
  std::optional<glove::Frame> frame(std::uint64_t n) const override {
    const model::HumanPosture q = glove::posture_of(pose);
    glove::Frame frame;
    frame.stamp = from_ns(static_cast<std::int64_t>(n) * 10'000'000);
    frame.readings.emplace_back();
    frame.joint_angles.assign(q.begin(), q.end());
    return frame;
  }
  std::atomic<glove::ShownPose> pose = glove::ShownPose::open;
};

TEST_F(GloveUse, AJointAngleGloveIsCalibratedThroughItsDriver) {
  const std::string port = (folder_ / "glove").string(), file = (folder_ / "anna.toml").string();
  glove::DeviceOptions worn;
  worn.joint_gains = *glove::typical_gains(22);
  for (double& gain : worn.joint_gains.gain) gain *= 1.1;
  auto emulation = glove::emulation_of(*glove::find_device("joint_glove"), worn, port);
  emulation.rate = 100;
  ShowingHand hand;
  const std::jthread glove([&](const std::stop_token& stop) {
    EXPECT_TRUE(glove::emulate(emulation, hand, [&] { return stop.stop_requested(); }));
  });
  ASSERT_TRUE(eventually(20, [&] { return std::filesystem::exists(port); }));
  stage::Process tool =
      start_program("prehend-glove-tool",
                    with_lab({"calibrate", "--user", "anna", "--out", file, "--limit", "60",
                              "--set", "glove.device=joint_glove", "--set", "glove.port=" + port}));
  for (const auto pose : glove::shown_poses) {
    hand.pose = pose;
    const std::string taken = std::string(glove::to_string(pose)) + " taken";
    EXPECT_TRUE(eventually(30, [&] {
      return text_of(tool.log()).find(taken) != std::string::npos;
    })) << taken;
  }
  const auto ended = tool.wait(seconds(10));
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->code, 0) << text_of(tool.log());
  const auto user = glove::load_user(file);
  ASSERT_TRUE(user) << user.error().message();
  ASSERT_EQ(user->gain.size(), 22u);
  // Index finger's first joint; 2 % is the rounding to whole counts.
  EXPECT_NEAR(user->gain[4] / worn.joint_gains.gain[4], 1, 0.02);

  // The service takes the file, and the fist is a fist.
  auto frames = reader(dds::glove_frame);
  hand.pose = glove::ShownPose::fist;
  auto service = start(
      "glove", {"glove.device=joint_glove", "glove.port=" + port, "glove.calibration=" + file});
  const model::HumanPosture fist = model::HumanHand::fist_posture();
  EXPECT_TRUE(hear<v1::GloveFrame>(frames, 20, [&](const v1::GloveFrame& message) {
    return message.joint_angles().size() == 20 &&
           std::abs(message.joint_angles()[1] - fist[1]) < 0.03;
  }));
}

TEST_F(GloveUse, ANewUserWorksWithAWarning) {
  auto postures = reader(dds::hand_posture);
  auto service = start("glove", {"glove.device=topic"});
  EXPECT_TRUE(eventually(20, [&] {
    publish(frame(place_, half_));
    return !postures.take().empty();
  }));
  EXPECT_THAT(text_of(service.log()), HasSubstr("has not been calibrated"));
}

// Guards: the gains in a user's file reach the joint-angle glove's driver.
TEST_F(GloveUse, GainsOfAnotherGloveAreRefused) {
  const std::string file = (folder_ / "anna.toml").string();
  glove::UserCalibration anna{.user = "anna", .gain = {0.01, 0.01}, .offset = {0, 0}};
  for (auto& bones : anna.bones) bones = {0.04, 0.03, 0.02};
  ASSERT_TRUE(glove::save(file, anna));
  auto arguments = lab_arguments(
      {"glove.device=joint_glove", "glove.port=" + file, "glove.calibration=" + file});
  const Answer answer = run("prehend-glove", arguments, 20);
  EXPECT_EQ(answer.exit_code, 3) << answer.log;
  EXPECT_NE(answer.log.find("18 or 22"), std::string::npos) << answer.log;
}

TEST_F(GloveUse, TheTrackerIsRegisteredByTouch) {
  const std::string lab = (folder_ / "lab.toml").string();
  std::ofstream(lab) << "[lab]\nrig = \"x\"\n\n[tracker]\nX_WT = [0, 0, 0, 1, 0, 0, 0]\n";
  const Pose X_WT = make_pose(Vector3d(0.05, 0.45, 0.3),
                              Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Vector3d::UnitZ())));
  const auto q = model::HumanHand::open_posture();
  const Vector3d p_HF = model::HumanHand(1).fingertip_poses(q)[1].translation();
  auto tool = start_program("prehend-glove-tool",
                            with_lab({"register", "--config", lab, "--write", "--limit", "60"}));
  const std::vector<Vector3d> corners{
      {-0.2, -0.15, 0}, {0.2, -0.15, 0}, {0.2, 0.15, 0}, {-0.2, 0.15, 0}};
  Vector3d from = corners.back();
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const auto taken = [&] {
      const std::string log = text_of(tool.log());
      std::size_t count = 0;
      for (auto at = log.find("taken"); at != std::string::npos; at = log.find("taken", at + 1))
        ++count;
      return count > c;
    };
    for (int n = 0; n <= 20; ++n)
      publish(frame(X_WT.inverse() * make_pose(from + n / 20. * (corners[c] - from) - p_HF), q));
    EXPECT_TRUE(eventually(20, [&] {
      publish(frame(X_WT.inverse() * make_pose(corners[c] - p_HF), q));
      return taken();
    })) << c;
    from = corners[c];
  }
  const auto ended = tool.wait(seconds(10));
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->code, 0);
  const auto config = service::Config::load(lab);
  ASSERT_TRUE(config) << config.error().message();
  const auto& n = config->numbers("tracker.X_WT");
  ASSERT_EQ(n.size(), 7u);
  const Pose found = make_pose({n[0], n[1], n[2]}, Eigen::Quaterniond(n[3], n[4], n[5], n[6]));
  EXPECT_TRUE(found.isApprox(X_WT, 1e-3));
  EXPECT_EQ(run("prehend-glove-tool",
                {"register", "--point", "0,0,0", "--point", "0.1,0,0", "--point", "0.2,0,0"}, 20)
                .exit_code,
            2)
      << "points on a line";
}

TEST_F(GloveUse, APersonWatchesIt) {
  auto service = start("glove", {"lab.scene=" + scene(1)});
  Terminal terminal(program("prehend"), with_lab({"glove", "watch"}));
  for (const char* word : {"synthetic", "back of hand", "valid", "postures/s", "tip", "running"})
    EXPECT_TRUE(terminal.shows(word)) << word;
  terminal.press("q\n");
  EXPECT_EQ(terminal.end(), 0);

  const Answer snapshot = run("prehend", with_lab({"glove", "watch", "--json"}), 20);
  ASSERT_EQ(snapshot.exit_code, 0) << snapshot.log;
  const auto document = nlohmann::json::parse(snapshot.output);
  EXPECT_EQ(document["frame"]["sensors"].size(), 4u);
  EXPECT_NEAR(document["frame"]["rate_hz"].get<double>(), 30, 6);
  EXPECT_TRUE(document["posture"]["fingertips_m"]["index"].is_array());
  EXPECT_TRUE(document["posture"]["fingertips_m"]["ring"].is_null());
  EXPECT_EQ(document["services"][0]["state"], "running");
  EXPECT_TRUE(document["services"][0]["latency_us"].contains("process"));
}

TEST_F(GloveUse, NothingToWatchIsSaid) {
  const Answer answer = run("prehend", with_lab({"glove", "watch", "--json", "--for", "0.5"}), 20);
  EXPECT_EQ(answer.exit_code, 1);
  EXPECT_TRUE(nlohmann::json::parse(answer.output)["frame"].is_null());
}

}  // namespace
}  // namespace prehend::integration
