// `prehend glove calibrate --from` with a whole set of poses, in each kind of file that its page
// names: the hand is found as large as it was, and the file is one that the glove takes. Guards a
// command that failed on every CSV.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/dds/topics.hpp"
#include "services/glove/core/bare_hand.hpp"
#include "services/glove/core/calibration/calibrator.hpp"
#include "services/glove/files/hand_recording.hpp"
#include "services/glove/files/user_file.hpp"
#include "services/glove/service/messages.hpp"
#include "tests/support/command_test.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/recorder_dataset_files/written_recording.hpp"

namespace prehend::glove {
namespace {

using Eigen::Vector3d;
using namespace std::string_literals;

constexpr double scale = 1.1;
constexpr int pictures = 80;  // a pose, at 30 Hz; the first 20 on the way to it

/// Landmarks of somebody who shows all poses, picture by picture.
std::vector<Landmarks> shown() {
  const model::HumanHand hand(scale);
  std::vector<Landmarks> all;
  model::HumanPosture before = posture_of(ShownPose::open);
  for (const ShownPose pose : shown_poses) {
    const model::HumanPosture q = posture_of(pose);
    for (int n = 0; n < pictures; ++n)
      all.push_back(landmarks_of(hand, before + std::min(1.0, n / 20.0) * (q - before)));
    before = q;
  }
  return all;
}

std::string landmark_csv(const std::string& time, const char* separator = ",",
                         bool decimal_comma = false) {
  std::string csv = time;
  for (int i = 0; i < 21; ++i)
    for (const char* axis : {"x", "y", "z"}) csv += fmt::format("{}l{}_{}", separator, i, axis);
  int frame = 0;
  for (const Landmarks& points : shown()) {
    csv += fmt::format("\n{}", time == "frame" ? frame : static_cast<int>(frame * 1000 / 30.0));
    ++frame;
    for (const Vector3d& p : points)
      for (const double x : p) {
        std::string number = fmt::format("{:.6f}", x);
        if (decimal_comma) std::ranges::replace(number, '.', ',');
        csv += separator + number;
      }
  }
  return csv + "\n";
}

std::string leap_csv() {
  std::string csv = "frame,t_us,fps,hand";
  const auto heading = [&](const std::string& name) {
    for (const char* axis : {"x", "y", "z"}) csv += fmt::format(",{}_{}", name, axis);
  };
  for (const char* name : {"palm", "dir", "normal", "middle_mcp"}) heading(name);
  constexpr std::array fingers{"thumb", "index", "middle", "ring", "pinky"};
  for (const char* finger : fingers)
    for (const char* part : {"_tip", "_dip"}) heading(std::string(finger) + part);
  int frame = 0;
  for (const Landmarks& points : shown()) {
    const BareHand bare = bare_hand(points, false);
    csv += fmt::format("\n{},{},30,right", frame, static_cast<int>(frame * 1e6 / 30));
    ++frame;
    const auto add = [&](const Vector3d& p) {
      csv += fmt::format(",{:.5f},{:.5f},{:.5f}", p.x(), p.y(), p.z());
    };
    add(1000 * bare.knuckle_R);
    add(bare.x_R);
    add(-bare.z_R);
    add(1000 * bare.knuckle_R);
    for (std::size_t f = 0; f < fingers.size(); ++f) {
      add(1000 * bare.tip_R[f]);
      add(1000 * bare.before_R[f]);
    }
  }
  return csv + "\n";
}

class Calibrate : public test::CommandTest {
 protected:
  Calibrate() : CommandTest(test::in_programs("prehend-glove-tool") + " calibrate") {}

  void finds_the_hand(const std::string& recording) {
    const auto answer = run("--user anna --from " + recording + " -o " + in("anna.toml"));
    EXPECT_EQ(answer.code, 0) << recording << ": " << answer.complaint;
    const auto user = load_user(in("anna.toml"));
    ASSERT_TRUE(user) << recording;
    EXPECT_NEAR(user->scale, scale, 0.06) << recording;
    EXPECT_EQ(user->user, "anna");
    std::filesystem::remove(in("anna.toml"));
  }
};

TEST_F(Calibrate, FromLandmarksAsSpreadsheetsAndProgramsWriteThem) {
  finds_the_hand(file("frames.csv", landmark_csv("frame")));
  finds_the_hand(file("times.csv", landmark_csv("timestamp_ms")));
  finds_the_hand(file("semicolons.csv", landmark_csv("frame", ";", true)));
}

TEST_F(Calibrate, FromALeapRecording) {
  finds_the_hand(file("leap.csv", leap_csv()));
}

TEST_F(Calibrate, FromARecordingOfTheGlovesTopic) {
  {
    recorder::dataset::WrittenRecording mcap(in("glove.mcap"));
    const auto frames = Recording::parse(landmark_csv("frame"), "landmarks", {});
    ASSERT_TRUE(frames);
    for (std::size_t n = 0; n < frames->size(); ++n)
      mcap.write(dds::glove_frame, static_cast<int>(n) * 33,
                 to_message(*frames->frame(n), "right", "landmarks"));
    mcap.close();
  }
  finds_the_hand(in("glove.mcap"));
}

// A recording that ends too early says which pose it lacks.
TEST_F(Calibrate, FromHalfASetSaysWhatIsMissing) {
  const std::string whole = landmark_csv("frame");
  std::size_t end = 0;
  for (int line = 0; line < pictures; ++line) end = whole.find('\n', end) + 1;
  const auto answer =
      run("--user anna --from " + file("half.csv", whole.substr(0, end)) + " -o " + in("a.toml"));
  EXPECT_EQ(answer.code, 1);
  EXPECT_FALSE(answer.complaint.empty());
  EXPECT_FALSE(std::filesystem::exists(in("a.toml")));
}

class GloveTool : public test::CommandTest {
 protected:
  GloveTool() : CommandTest(test::in_programs("prehend-glove-tool")) {}
};

TEST_F(GloveTool, SaysInOneLineWhatItCannotUse) {
  {
    recorder::dataset::WrittenRecording mcap(in("other.mcap"));
    mcap.close();
  }
  for (const auto& [arguments, code, words] :
       {std::tuple("calibrate --user anna -o " + in("a.toml") + " --from " + in("other.mcap"), 3,
                   "other.mcap: holds nothing of a glove, on glove/frame"),
        std::tuple("register --point 1,2"s, 2, "--point 1,2: must be X,Y,Z in m"),
        std::tuple("emulate --from telepathy"s, 3,
                   "--from: 'telepathy' is no source (give synthetic or recording:FILE)")}) {
    const auto answer = run(arguments);
    EXPECT_EQ(answer.code, code) << arguments;
    EXPECT_THAT(answer.complaint, ::testing::HasSubstr(words)) << arguments;
  }
}

}  // namespace
}  // namespace prehend::glove
