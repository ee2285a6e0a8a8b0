// Recordings of bare hands: every frame once, with the recorded times, in the shape of a hand.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <tuple>
#include <vector>

#include "services/glove/core/bare_hand.hpp"
#include "services/glove/core/features.hpp"
#include "services/glove/core/processor.hpp"
#include "services/glove/files/hand_recording.hpp"
#include "tests/support/shared_data.hpp"

namespace prehend::glove {
namespace {

using Eigen::Vector3d;
namespace fs = std::filesystem;

const RecordingOptions room{.X_WT = make_pose(Vector3d(0, 0.45, 0.3)),
                            .X_WH = make_pose(Vector3d(0.05, 0, 0.25))};

/// Finite, increasing in time, the hand where the scene puts it, fingers of a hand's length.
void expect_plausible(const Recording& recording) {
  std::optional<Time> last;
  for (std::size_t n = 0; n < recording.size(); ++n) {
    const auto frame = recording.frame(n);
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->sequence, n);
    if (last) {
      EXPECT_GT(frame->stamp, *last);
    }
    last = frame->stamp;
    ASSERT_EQ(frame->readings.size(), 6u);
    const Reading& back = frame->readings[0];
    ASSERT_EQ(back.site, Site::back_of_hand);
    const Pose X_TH = make_pose(back.p_TS, back.q_TS);
    EXPECT_TRUE((room.X_WT * X_TH).isApprox(room.X_WH, 1e-9));
    for (std::size_t s = 1; s < 6; ++s) {
      ASSERT_TRUE(frame->readings[s].p_TS.allFinite());
      EXPECT_NEAR(frame->readings[s].q_TS.norm(), 1, 1e-9);
      EXPECT_LT(invariant_feature(X_TH, frame->readings[s].p_TS).norm(), 0.25);
    }
  }
}

TEST(Recording, ReadsTheLeapRecordings) {
  const fs::path folder = shared_data() / "leap_hand_recordings";
  if (!fs::exists(folder)) GTEST_SKIP() << "no " << folder;
  // Frames of right hands, from the folder's index; three-claps and flapping hold both hands.
  const std::vector<std::pair<std::string, std::size_t>> files{
      {"grab", 374}, {"pinch", 307}, {"HandSplay-110fps", 288}, {"wave", 111}, {"brian", 500}};
  for (const auto& [name, frames] : files) {
    const auto recording = Recording::load(folder / (name + ".csv"), room);
    ASSERT_TRUE(recording) << recording.error().message();
    EXPECT_EQ(recording->size(), frames) << name;
    EXPECT_EQ(recording->unreadable(), 0u) << name;
    expect_plausible(*recording);
  }
  for (const std::string name : {"three-claps", "flapping"}) {
    const auto recording = Recording::load(folder / (name + ".csv"), room);
    ASSERT_TRUE(recording) << recording.error().message();
    EXPECT_GT(recording->other_hand(), 300u);
    EXPECT_FALSE(recording->left());
    expect_plausible(*recording);
  }
}

TEST(Recording, KeepsTheRecordedTimes) {
  const fs::path file = shared_data() / "leap_hand_recordings" / "grab.csv";
  if (!fs::exists(file)) GTEST_SKIP() << "no " << file;
  const auto recording = Recording::load(file, room);
  ASSERT_TRUE(recording);
  EXPECT_EQ(recording->frame(0)->stamp, Time{});
  const double length = to_seconds(recording->frame(373)->stamp.time_since_epoch());
  EXPECT_GT(length, 374 / 115.);  // the camera's best rate
  EXPECT_LT(length, 374 / 50.);
  EXPECT_FALSE(recording->frame(374));
}

TEST(Recording, ClosesTheHandInGrab) {
  const fs::path file = shared_data() / "leap_hand_recordings" / "grab.csv";
  if (!fs::exists(file)) GTEST_SKIP() << "no " << file;
  const auto recording = Recording::load(file, room);
  ASSERT_TRUE(recording);
  double nearest = 1, farthest = 0;
  for (std::size_t n = 0; n < recording->size(); ++n) {
    const auto frame = recording->frame(n);
    const Pose X_TH = make_pose(frame->readings[0].p_TS, frame->readings[0].q_TS);
    const Vector3d middle = invariant_feature(X_TH, frame->readings[3].p_TS);
    nearest = std::min(nearest, middle.x());
    farthest = std::max(farthest, middle.x());
    // Fingers are on the palm's side or near the plane of the hand, the thumb toward +y of the
    // little finger: this is a right hand.
    EXPECT_LT(middle.z(), 0.06);
    EXPECT_GT(invariant_feature(X_TH, frame->readings[1].p_TS).y(),
              invariant_feature(X_TH, frame->readings[5].p_TS).y());
  }
  EXPECT_GT(farthest, 0.12) << "open";
  EXPECT_LT(nearest, 0.08) << "closed";
}

TEST(Recording, ReadsTheLandmarks) {
  const fs::path file = shared_data() / "landmark_hand_recording" / "human_joint_right.csv";
  if (!fs::exists(file)) GTEST_SKIP() << "no " << file;
  const auto recording = Recording::load(file, room);
  ASSERT_TRUE(recording) << recording.error().message();
  EXPECT_EQ(recording->size(), 621u);
  expect_plausible(*recording);
  EXPECT_NEAR(to_seconds(recording->frame(30)->stamp.time_since_epoch()), 1, 1e-9) << "30 Hz";
  for (std::size_t n = 0; n < recording->size(); ++n) {
    const auto frame = recording->frame(n);
    const Pose X_TH = make_pose(frame->readings[0].p_TS, frame->readings[0].q_TS);
    EXPECT_GT(invariant_feature(X_TH, frame->readings[2].p_TS).y(),
              invariant_feature(X_TH, frame->readings[5].p_TS).y());
  }
}

// What comes out of a real recording passes the core nearly whole.
TEST(Recording, PassesTheProcessor) {
  for (const char* name : {"leap_hand_recordings/grab.csv", "leap_hand_recordings/pinch.csv",
                           "landmark_hand_recording/human_joint_right.csv"}) {
    const fs::path file = shared_data() / name;
    if (!fs::exists(file)) GTEST_SKIP() << "no " << file;
    const auto recording = Recording::load(file, room);
    ASSERT_TRUE(recording);
    Processor processor({.X_WT = room.X_WT});
    std::size_t published = 0, full = 0;
    for (std::size_t n = 0; n < recording->size(); ++n) {
      const auto frame = recording->frame(n);
      const Processed out = processor.process(*frame, frame->stamp);
      published += out.posture.has_value();
      full += out.posture && out.posture->quality == 1;
    }
    EXPECT_EQ(published, recording->size() - 1) << name << ": all but the first";
    EXPECT_GT(full, recording->size() * 95 / 100) << name;
  }
}

constexpr const char* header =
    "frame,t_us,fps,hand,palm_x,palm_y,palm_z,dir_x,dir_y,dir_z,normal_x,normal_y,normal_z";

/// A Leap row of a flat hand at `t`; a left one is the mirror image of a right one.
std::string leap(long long t, bool left, double thumb_x = -60) {
  const double s = left ? -1 : 1;
  std::string row =
      fmt::format("{},{},100,{},0,100,0,0,0,-1,0,-1,0", t / 10000, t, left ? "left" : "right");
  const std::array<Vector3d, 5> tips{Vector3d(thumb_x, 100, -20), Vector3d(-30, 100, -90),
                                     Vector3d(0, 100, -100), Vector3d(25, 100, -90),
                                     Vector3d(50, 100, -70)};
  for (const Vector3d& p : tips)
    for (const double back : {60., 20., 0.})  // mcp, dip, tip
      row += fmt::format(",{},{},{}", s * p.x(), p.y(), p.z() + back);
  return row + "\n";
}

std::string leap_header() {
  std::string text = header;
  for (const char* finger : {"thumb", "index", "middle", "ring", "pinky"})
    for (const char* joint : {"mcp", "dip", "tip"})
      text += fmt::format(",{0}_{1}_x,{0}_{1}_y,{0}_{1}_z", finger, joint);
  return text + "\n";
}

TEST(Recording, MirrorsALeftHandIntoARightOne) {
  const auto right = Recording::parse(leap_header() + leap(0, false), "right", room);
  const auto left = Recording::parse(leap_header() + leap(0, true), "left", room);
  ASSERT_TRUE(right && left);
  EXPECT_FALSE(right->left());
  EXPECT_TRUE(left->left());
  EXPECT_TRUE(left->frame(0)->left);
  for (std::size_t s = 0; s < 6; ++s)
    EXPECT_LT((right->frame(0)->readings[s].p_TS - left->frame(0)->readings[s].p_TS).norm(), 1e-9);
}

TEST(Recording, SkipsWhatIsNoHand) {
  std::string text = leap_header() + leap(0, false) + leap(10000, true) + leap(20000, false);
  text += leap(20000, false);           // a second right hand in the same picture
  text += "3,30000,100,right,1,2,3\n";  // cut off
  text += leap(15000, false);           // earlier
  text += leap(40000, false, NAN);      // not a number
  const auto recording = Recording::parse(text, "mixed", room);
  ASSERT_TRUE(recording);
  EXPECT_EQ(recording->size(), 2u);
  EXPECT_EQ(recording->other_hand(), 1u);
  EXPECT_EQ(recording->unreadable(), 4u);
}

// Found by fuzzing: times that differ by less than the nanosecond of a stamp made two equal stamps.
TEST(Recording, RefusesTwoTimesWithinANanosecond) {
  std::string second = leap(0, false);
  second.replace(second.find(",0,"), 3, ",0.0001,");  // t_us
  const auto recording = Recording::parse(leap_header() + leap(0, false) + second, "close", room);
  ASSERT_TRUE(recording);
  EXPECT_EQ(recording->size(), 1u);
  EXPECT_EQ(recording->unreadable(), 1u);
}

// Lengths in metres or centimetres, and times in ms or s, made a hand that nothing could be done
// with, without a word.
TEST(Recording, RefusesOtherUnits) {
  const auto with = [](double length, double time) {
    std::string text = leap_header();
    for (int n = 0; n < 20; ++n) {
      const std::string row = leap(0, false);
      text += fmt::format("{},{},100,right", n, n * 10000 * time);
      // frame,t_us,fps,hand,palm, then directions, which have no unit
      std::vector<std::string> cells(1);
      for (const char c : row.substr(0, row.size() - 1))
        if (c == ',')
          cells.emplace_back();
        else
          cells.back() += c;
      for (std::size_t i = 4; i < cells.size(); ++i)
        text += fmt::format(",{}", std::stod(cells[i]) * (i >= 7 && i < 13 ? 1 : length));
      text += "\n";
    }
    return Recording::parse(text, "scaled", room);
  };
  ASSERT_TRUE(with(1, 1)) << with(1, 1).error().message();
  EXPECT_EQ(with(1, 1)->size(), 20u);
  for (const double length : {0.001, 0.1, 1000.}) {
    const auto refused = with(length, 1);
    ASSERT_FALSE(refused) << length;
    EXPECT_EQ(refused.error().hint, "positions are in mm");
  }
  for (const double time : {1e-3, 1e-6}) EXPECT_FALSE(with(1, time)) << time;
}

TEST(Recording, SaysWhatWasLeftOut) {
  const auto mixed = Recording::parse(
      leap_header() + leap(0, false) + leap(10000, true) + leap(0, false), "mixed", room);
  ASSERT_TRUE(mixed);
  EXPECT_EQ(
      mixed->left_out(),
      "1 rows say nothing usable, or are not later than those before; 1 rows of the left hand");
  EXPECT_EQ(Recording::parse(leap_header() + leap(0, false), "whole", room)->left_out(), "");
}

/// Landmarks of a hand that closes, in rows of these times: the hand model's, moved and scaled.
struct Table {
  std::vector<double> times;
  std::string column = "frame";
  double scale = 1;
  bool mirrored = false, picture = false;

  std::string text() const {
    std::string all = column;
    for (int i = 0; i < 21; ++i) all += fmt::format(",l{0}_x,l{0}_y,l{0}_z", i);
    for (std::size_t n = 0; n < times.size(); ++n) {
      const double closure = static_cast<double>(n) / static_cast<double>(times.size());
      Landmarks points =
          landmarks_of(model::HumanHand(1),
                       model::HumanHand::posture({closure, closure, closure, closure, closure}));
      all += fmt::format("\n{}", times[n]);
      const Vector3d wrist = points[0];
      for (const Vector3d& p : points) {
        const Vector3d shown = picture ? Vector3d(0.5, 0.8, 0) + 4 * (p - wrist) : p;
        all += fmt::format(",{},{},{}", scale * shown.x(), scale * (mirrored ? -1 : 1) * shown.y(),
                           scale * shown.z());
      }
    }
    return all + "\n";
  }
};

std::vector<double> counted(int rows, double step = 1) {
  std::vector<double> times;
  for (int n = 0; n < rows; ++n) times.push_back(n * step);
  return times;
}

TEST(Recording, UnitsOfLandmarksAreNamed) {
  ASSERT_TRUE(Recording::parse(Table{counted(30)}.text(), "good", room));
  for (const auto& [scale, picture, what] :
       {std::tuple(1000.0, false, "in millimetres"), std::tuple(100.0, false, "in centimetres"),
        std::tuple(1.0, true, "in image coordinates"), std::tuple(0.1, false, "not a hand")}) {
    Table table{counted(30)};
    table.scale = scale;
    table.picture = picture;
    const auto refused = Recording::parse(table.text(), "other", room);
    ASSERT_FALSE(refused) << what;
    EXPECT_NE(refused.error().what.find(what), std::string::npos) << refused.error().message();
  }
}

// Guards a left hand that was read as a right one: its fingers bent backwards.
TEST(Recording, BentFingersTellTheHand) {
  Table table{counted(30)};
  const auto right = Recording::parse(table.text(), "right", room);
  table.mirrored = true;
  const auto left = Recording::parse(table.text(), "left", room);
  ASSERT_TRUE(right && left);
  EXPECT_FALSE(right->left());
  EXPECT_TRUE(right->remarks().empty());
  EXPECT_TRUE(left->left());
  ASSERT_EQ(left->remarks().size(), 1u);
  EXPECT_NE(left->remarks()[0].find("left hand"), std::string::npos);
  ASSERT_EQ(left->size(), 30u);
  for (std::size_t n = 0; n < 30; ++n)
    for (std::size_t s = 1; s < 6; ++s) {
      const auto in_hand = [&](const Recording& recording) {
        const Frame frame = *recording.frame(n);
        return invariant_feature(make_pose(frame.readings[0].p_TS, frame.readings[0].q_TS),
                                 frame.readings[s].p_TS);
      };
      EXPECT_LT((in_hand(*left) - in_hand(*right)).norm(), 1e-9);
    }
}

TEST(Recording, TimesGapsAndRestartsAreRead) {
  for (const auto& [column, step] :
       {std::pair("timestamp_ms", 33.0), std::pair("t_s", 0.033), std::pair("TIME_US", 33000.0)}) {
    const auto recording = Recording::parse(Table{counted(30, step), column}.text(), "t", room);
    ASSERT_TRUE(recording) << recording.error().message();
    EXPECT_NEAR(to_seconds(recording->frame(10)->stamp.time_since_epoch()), 0.33, 1e-6) << column;
  }
  const auto unknown = Recording::parse(Table{counted(30), "timestamp"}.text(), "t", room);
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().message().find("timestamp_ms"), std::string::npos);
  const auto none = Recording::parse(Table{counted(30), "number"}.text(), "t", room);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message().find("no column says when"), std::string::npos);

  std::vector<double> twice = counted(30), lost = counted(40);
  for (const double time : counted(30)) twice.push_back(time);
  lost.erase(lost.begin() + 10, lost.begin() + 20);
  const auto restarted = Recording::parse(Table{twice}.text(), "twice", room);
  ASSERT_TRUE(restarted);
  EXPECT_EQ(restarted->size(), 60u);
  ASSERT_EQ(restarted->remarks().size(), 1u);
  EXPECT_NE(restarted->remarks()[0].find("begin anew in line 32"), std::string::npos)
      << restarted->remarks()[0];
  const auto gap = Recording::parse(Table{lost}.text(), "lost", room);
  ASSERT_TRUE(gap);
  EXPECT_EQ(gap->size(), 30u);
  ASSERT_EQ(gap->remarks().size(), 1u);
  EXPECT_NE(gap->remarks()[0].find("0.37 s before line 12"), std::string::npos)
      << gap->remarks()[0];
}

// What others sent: each is read or its fault named.
TEST(Recording, ReadsOrNamesWhatStrangersBring) {
  const fs::path folder = shared_data() / "strangers" / "16-landmark-csv";
  if (!fs::exists(folder)) GTEST_SKIP() << "no " << folder;
  const auto read = [&](const char* name) { return Recording::load(folder / name, room); };
  for (const char* name :
       {"good.csv", "capital_header.csv", "excel_german.csv", "excel_utf8_bom_crlf.csv",
        "timestamp_not_frame.csv", "frame_numbers_restart.csv", "left_hand.csv"}) {
    ASSERT_TRUE(read(name)) << name << read(name).error().message();
    EXPECT_EQ(read(name)->size(), 90u) << name;
  }
  EXPECT_TRUE(read("left_hand.csv")->left());
  EXPECT_FALSE(read("frame_numbers_restart.csv")->remarks().empty());
  EXPECT_FALSE(read("lost_frames.csv")->remarks().empty() &&
               read("lost_frames.csv")->left_out().empty());
  EXPECT_NE(read("millimetres.csv").error().what.find("millimetres"), std::string::npos);
  EXPECT_NE(read("image_0_to_1.csv").error().what.find("image"), std::string::npos);
}

TEST(Recording, RefusesOtherFiles) {
  EXPECT_FALSE(Recording::load("/nowhere/to/be/found.csv", room));
  EXPECT_FALSE(Recording::load("/", room));
  EXPECT_FALSE(Recording::parse("", "empty", room));
  EXPECT_FALSE(Recording::parse("a,b,c\n1,2,3\n", "other", room));
  EXPECT_FALSE(Recording::parse(leap_header(), "no rows", room));
}

}  // namespace
}  // namespace prehend::glove
