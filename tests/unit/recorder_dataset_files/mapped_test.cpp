// Recordings of other stacks as training data: the same rows whatever their messages were encoded
// in, parts of the episodes, and reasons where something cannot be mapped.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "common/recording/mcap/writer.hpp"
#include "services/recorder/tools/dataset/columns_file.hpp"
#include "services/recorder/tools/dataset/export.hpp"
#include "services/recorder/tools/dataset/gather.hpp"
#include "services/recorder/tools/dataset/hdf5_file.hpp"
#include "services/recorder/tools/dataset/layouts.hpp"
#include "services/recorder/tools/dataset/pictures.hpp"
#include "services/recorder/tools/dataset/video_file.hpp"
#include "tests/support/foreign/foreign.hpp"
#include "tests/unit/recording/scratch.hpp"

namespace prehend::recorder::dataset {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string jpeg() {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", cv::Mat(48, 64, CV_8UC3, cv::Scalar(20, 40, 200)), bytes);
  return {bytes.begin(), bytes.end()};
}

class MappedTest : public ::testing::Test {
 protected:
  std::string record(test::Stack stack, bool pictures = false) {
    const auto path = scratch_ / "theirs.mcap";
    test::write_recording(path, stack, pictures ? jpeg() : "");
    return path.string();
  }
  std::string write(const std::string& columns) {
    testing::write_bytes(scratch_ / "columns.toml", columns);
    return (scratch_ / "columns.toml").string();
  }
  DatasetOptions options(test::Stack stack, const std::string& columns, bool pictures = false) {
    return {.sources = {record(stack, pictures)},
            .format = "robomimic",
            .output = (scratch_ / "out").string(),
            .rate = 10,
            .columns = write(columns)};
  }
  /// Why nothing is made of it.
  std::string refused(const std::string& columns) {
    const auto gathered = gather(options(test::Stack::ros2msg, columns));
    return gathered ? "taken" : gathered.error().message();
  }

  const testing::Scratch scratch_;
};

TEST_F(MappedTest, EveryEncodingGivesTheSameRows) {
  for (const test::Stack stack : test::all_stacks) {
    const auto all = gather(options(stack, test::columns_of_recording(true), true));
    ASSERT_TRUE(all) << all.error().message();
    EXPECT_TRUE(all->passed_by.empty()) << all->passed_by[0].message();
    EXPECT_EQ(all->dataset.hand, "theirs");
    ASSERT_EQ(all->dataset.episodes.size(), 1u);
    const RecordedEpisode& episode = all->dataset.episodes[0];
    const Rows& rows = episode.rows;
    EXPECT_EQ(episode.episode.task, "wave");
    EXPECT_THAT(rows.state.columns, ElementsAre("a", "b"));
    ASSERT_EQ(rows.count, 21);
    for (Eigen::Index row = 0; row < rows.count; ++row) {
      const double t = 0.1 * static_cast<double>(row);
      // Elements are found by their names, in whatever order they come.
      EXPECT_NEAR(rows.state.values(row, 0), t, 1e-6);
      EXPECT_NEAR(rows.state.values(row, 1), 2 * t, 1e-6);
      EXPECT_NEAR(rows.action.values(row, 1), 2 * t + 0.1, 1e-6);
      EXPECT_NEAR(rows.others[0].values(row, 0), t, 1e-6);
      EXPECT_NEAR(rows.others[0].values(row, 3), std::cos(t / 2), 1e-6);  // w
      EXPECT_NEAR(rows.others[0].values(row, 6), std::sin(t / 2), 1e-6);  // z
      EXPECT_EQ(rows.others[1].values(row, 0), 2);
    }
    EXPECT_EQ(all->dataset.cameras.at("front").width, 64);
    int shown = 0;
    const auto read = read_rows(episode, "front", {64, 48}, [&](const Rgb& picture) {
      EXPECT_NEAR(picture.bytes[0], 200, 6);
      ++shown;
      return Expected<void>();
    });
    EXPECT_TRUE(read) << read.error().message();
    EXPECT_EQ(shown, 21);
  }
}

TEST_F(MappedTest, RawPicturesOfEveryStackAreShown) {
  std::string pixels;
  for (int i = 0; i < 10 * 6; ++i) pixels += {20, 40, static_cast<char>(200)};
  for (const test::Stack stack : test::all_stacks) {
    auto asked = options(stack, test::columns_of_recording(true));
    test::write_recording(asked.sources[0], stack, "", {10, 6, pixels});
    const auto all = gather(asked);
    ASSERT_TRUE(all) << all.error().message();
    EXPECT_EQ(all->dataset.cameras.at("front").height, 6);
    int shown = 0;
    const auto read =
        read_rows(all->dataset.episodes.at(0), "front", {10, 6}, [&](const Rgb& picture) {
          EXPECT_THAT(std::vector(picture.bytes.end() - 3, picture.bytes.end()),
                      ElementsAre(200, 40, 20));
          ++shown;
          return Expected<void>();
        });
    EXPECT_TRUE(read) << read.error().message();
    EXPECT_EQ(shown, 21);
  }
}

TEST_F(MappedTest, EpisodesAreThoseOfATopic) {
  const auto all = gather(options(
      test::Stack::ros1,
      test::columns_of_recording(false, "episodes = {topic = \"/run\", field = \"data\"}\n")));
  ASSERT_TRUE(all) << all.error().message();
  ASSERT_EQ(all->dataset.episodes.size(), 2u);
  EXPECT_EQ(all->dataset.episodes[0].rows.count, 8);
  EXPECT_NEAR(all->dataset.episodes[1].rows.state.values(0, 0), 1.1, 1e-6);
}

TEST_F(MappedTest, EpisodesAndPartsAreGiven) {
  auto asked = options(test::Stack::json, test::columns_of_recording(false));
  for (const char* part : {"0..0.3", "0.4..0.7", "0.8..1.1", "1.2..1.5", "1.6..1.9"})
    asked.episodes.emplace_back(part);
  asked.split = "train=0.8,valid=0.2";
  const auto all = gather(asked);
  ASSERT_TRUE(all) << all.error().message();
  ASSERT_EQ(all->dataset.episodes.size(), 5u);
  EXPECT_THAT(all->dataset.splits, ElementsAre(std::pair(std::string("train"), 4u),
                                               std::pair(std::string("valid"), 1u)));
  EXPECT_EQ(all->dataset.episodes[3].split, "train");
  EXPECT_EQ(all->dataset.episodes[4].split, "valid");
}

std::vector<std::string> names_of_mask(const std::string& file, const std::string& mask) {
  const hid_t opened = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t set = H5Dopen2(opened, mask.c_str(), H5P_DEFAULT);
  std::vector<std::string> names;
  if (set >= 0) {
    const hid_t space = H5Dget_space(set);
    names.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    H5Sclose(space);
    H5Dclose(set);
  }
  H5Fclose(opened);
  return names;
}

TEST_F(MappedTest, RobomimicAndLerobotNameTheParts) {
  auto asked = options(test::Stack::protobuf, test::columns_of_recording(false));
  for (const char* part : {"0..0.3", "0.4..0.7", "0.8..1.1", "1.2..1.5"})
    asked.episodes.emplace_back(part);
  asked.split = "train=0.75,valid=0.25";
  EXPECT_EQ(write_dataset(asked), 0);
  EXPECT_EQ(names_of_mask(asked.output, "/mask/train").size(), 3u);
  EXPECT_EQ(names_of_mask(asked.output, "/mask/valid").size(), 1u);
  for (const char* format : {"lerobot", "lerobot-v2.1"}) {
    asked.format = format;
    asked.output = (scratch_ / format).string();
    EXPECT_EQ(write_dataset(asked), 0);
    std::ifstream file(std::filesystem::path(asked.output) / "meta" / "info.json");
    const auto info = nlohmann::json::parse(file);
    EXPECT_EQ(info["splits"]["train"], "0:3");
    EXPECT_EQ(info["splits"]["valid"], "3:4");
    EXPECT_EQ(info["robot_type"], "theirs");
    EXPECT_EQ(info["features"]["action"]["names"], (nlohmann::json{"a", "b"}));
  }
  asked.format = "aloha";
  asked.output = (scratch_ / "aloha").string();
  EXPECT_EQ(write_dataset(asked), 0);
}

TEST_F(MappedTest, PicturesThatAreGoneOrSpoiltAreSaid) {
  const auto asked = options(test::Stack::json, test::columns_of_recording(true), true);
  const auto all = gather(asked);
  ASSERT_TRUE(all) << all.error().message();
  test::write_recording(asked.sources[0], test::Stack::json, "no picture");
  const auto spoilt = read_rows(all->dataset.episodes[0], "front", {64, 48},
                                [](const Rgb&) { return Expected<void>(); });
  ASSERT_FALSE(spoilt);
  EXPECT_EQ(spoilt.error().message(), asked.sources[0] + ": no picture of front can be decoded");
  test::write_recording(asked.sources[0], test::Stack::json);
  const auto gone = write_aloha(all->dataset, scratch_ / "out", [] {});
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().message(), asked.sources[0] + ": no picture of front");
}

TEST_F(MappedTest, ARobotOfOtherJointsIsNoPartOfTheSet) {
  auto asked = options(test::Stack::json,
                       "[[state]]\ntopic = \"/joint_states\"\nfield = \"position\"\nnames = "
                       "\"name\"\n[[action]]\ntopic = \"/command\"\nfield = \"position\"\nnames = "
                       "\"name\"\n");
  asked.sources.push_back((scratch_ / "other.mcap").string());
  auto writer = recording::mcap::Writer::create(asked.sources[1]).value();
  const auto schema = test::joints_schema(test::Stack::json);
  const auto id = writer.add_schema(schema.name, schema.encoding, schema.data).value();
  const auto data = test::message(test::Stack::json, test::Joints{{"c"}, {1}, {}});
  for (const char* topic : {"/joint_states", "/command"}) {
    const auto channel =
        writer.add_channel(id, topic, test::encoding_of(test::Stack::json)).value();
    for (const std::uint64_t t : {0u, 500u, 1000u})
      ASSERT_TRUE(writer.write(recording::mcap::Message{channel, 1, t * 1'000'000, 0, data}));
  }
  ASSERT_TRUE(writer.close());
  const auto all = gather(asked);
  ASSERT_FALSE(all);
  EXPECT_THAT(all.error().message(),
              HasSubstr("other.mcap: its states or actions have other elements than those before "
                        "(name those that all have: only = [...] in "));
}

TEST_F(MappedTest, WhatIsAskedForWronglyIsSaid) {
  auto asked = options(test::Stack::json, test::columns_of_recording(false));
  asked.hands = {"left"};
  EXPECT_EQ(check(asked).error().message(),
            "--hand: is for our own topics (--columns names topics)");
  asked.hands = {};
  asked.episodes = {"2..x"};
  EXPECT_EQ(check(asked).error().message(),
            "--episode 2..x: is no part of a recording (FROM..TO, seconds after its begin, as "
            "2.5..10)");
  asked.episodes = {};
  const std::string unfinished = asked.output + ".unfinished";
  testing::write_bytes(unfinished, std::string("of another export"));
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(write_dataset(asked), exit_wrong_use);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              HasSubstr(unfinished + ": is there already (of an export that was killed? remove"));
}

// A name that is taken, a name twice in a file, and a folder that is not there.
TEST_F(MappedTest, FilesOfTrainingDataThatCannotBeWrittenAreSaid) {
  const auto path = scratch_ / "a.hdf5";
  auto file = Hdf5File::create(path);
  ASSERT_TRUE(file);
  EXPECT_EQ(Hdf5File::create(path).error().message(),
            path.string() + ": cannot be written (is the folder writable?)");
  for (int i = 0; i < 2; ++i) file->write("/twice", std::vector<std::string>{"x"});
  EXPECT_EQ(file->close().error().message(),
            path.string() + ": cannot be written (is the disk full?)");
  const auto video = VideoFile::create("/nowhere/a.mp4", {64, 48}, 10);
  ASSERT_FALSE(video);
  EXPECT_EQ(video.error().message(),
            "/nowhere/a.mp4: cannot be written: No such file or directory");
}

TEST_F(MappedTest, WhatCannotBeMappedIsSaid) {
  const std::string sound = test::columns_of_recording(false);
  EXPECT_EQ(refused(sound), "taken");
  const auto with = [&](const std::string& what, const std::string& by) {
    std::string other = sound;
    return other.replace(other.find(what), what.size(), by);
  };
  EXPECT_THAT(refused(with("/tool", "/nowhere")),
              HasSubstr("has no message of /nowhere whose field «pose» can be used (prehend "
                        "recording info"));
  EXPECT_THAT(refused(with("\"pose\"", "\"pose.place\"")),
              HasSubstr("field «pose.place» is not there"));
  EXPECT_THAT(refused(with("\"velocity\"", "\"header.frame_id\"")),
              HasSubstr("is not of finite numbers"));
  EXPECT_THAT(refused(with("[\"b\"]", "[\"c\"]")), HasSubstr("has no element «c»"));
  EXPECT_THAT(refused(with("[[action]]", "[[observation]]")), HasSubstr("columns.toml: line"));
  EXPECT_THAT(refused(sound + "[[picture]]\nname = \"p\"\ntopic = \"/tool\"\nfield = \"pose\"\n"),
              HasSubstr("is no picture"));
}

TEST(ColumnsFile, SaysWhatIsWrongWithItsLine) {
  const std::string state = "[[state]]\ntopic = \"/a\"\nfield = \"x\"\n",
                    action = "[[action]]\ntopic = \"/a\"\nfield = \"x[2].y\"\n";
  EXPECT_TRUE(parse_columns(state + action, "c.toml"));
  for (const auto& [text, expected] : {
           std::pair(state, "c.toml: line 1: [[action]] is missing"),
           std::pair(action, "[[state]] is missing"),
           std::pair(state + action + "colour = 1\n", "line 7: colour is not known here"),
           std::pair("[state]\ntopic = \"/a\"\n" + action, "line 1: write [[state]]"),
           std::pair(state + "[[action]]\ntopic = 5\nfield = \"x\"\n", "line 5: topic is no text"),
           std::pair(state + "[[action]]\ntopic = \"/a\"\n", "line 4: field is missing"),
           std::pair(state + "[[action]]\ntopic = \"/a\"\nfield = \"x[\"\n",
                     "line 6: «x[» is no field"),
           std::pair(state + "[[action]]\ntopic = \"/a\"\nfield = \"x..y\"\n", "line 6"),
           std::pair("episodes = {gap = -1}\n" + state + action, "line 1: gap is above 0"),
           std::pair("episodes = {gap = 1, topic = \"/a\"}\n" + state + action,
                     "either a topic or a gap"),
           std::pair(
               state + action + "[[observation]]\nname = \"../x\"\ntopic = \"/a\"\nfield = \"x\"\n",
               "line 8: a name has up to 64"),
           std::pair(state + action +
                         "[[observation]]\nname = \"state\"\ntopic = \"/a\"\nfield = \"x\"\n",
                     "line 8: state is there twice"),
           std::pair(std::string("x ="), "line 1"),
       }) {
    const auto read = parse_columns(text, "c.toml");
    ASSERT_FALSE(read) << text;
    EXPECT_THAT(read.error().message(), HasSubstr(expected)) << text;
    EXPECT_EQ(read.error().exit, exit_wrong_use);
  }
}

}  // namespace
}  // namespace prehend::recorder::dataset
