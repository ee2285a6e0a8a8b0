// `prehend recording export` as a user calls it: the recordings of deploy/samples in each layout of
// training data, videos decoded again, and one clear line for what cannot be exported. That others
// read what is written: tests/interop/dataset.
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/support/command_test.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/recording/scratch.hpp"

namespace prehend {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

const std::string samples = test::in_sources("deploy/samples");
const std::string with_pictures = samples + "/intelligent-grasp.mcap";

using test::Answer;

long lines(const Answer& answer) {
  return std::ranges::count(answer.complaint, '\n');
}

class Export : public ::testing::Test {
 protected:
  Answer run(const std::string& text) {
    return test::answer_to("cd " + (scratch_ / "").string() + " && PATH=" + test::in_programs("") +
                               ":$PATH && (" + text + "\n)",
                           scratch_ / "");
  }
  static std::string read(const std::filesystem::path& path) {
    const auto bytes = testing::file_bytes(path);
    return {bytes.begin(), bytes.end()};
  }
  Json json(const std::string& name) const { return Json::parse(read(scratch_ / name)); }
  bool there(const std::string& name) const { return std::filesystem::exists(scratch_ / name); }

  /// It is refused with that one line, and nothing is left behind.
  void refused(const std::string& arguments, int code, const std::string& words) {
    const Answer answer = run("prehend recording export " + arguments + " -o refused");
    EXPECT_EQ(answer.code, code) << arguments;
    EXPECT_EQ(lines(answer), 1) << answer.complaint;
    EXPECT_THAT(answer.complaint, HasSubstr(words)) << arguments;
    EXPECT_FALSE(there("refused"));
    EXPECT_FALSE(there("refused.unfinished"));
  }

  const testing::Scratch scratch_;
};

/// What a video shows: times and mean brightness of its pictures.
struct Shown {
  std::vector<double> times;       // s
  std::vector<double> brightness;  // 0 to 255
};

Shown decode(const std::filesystem::path& path) {
  Shown shown;
  AVFormatContext* file = nullptr;
  if (avformat_open_input(&file, path.c_str(), nullptr, nullptr) < 0) return shown;
  avformat_find_stream_info(file, nullptr);
  const AVCodec* codec = nullptr;
  const int stream = av_find_best_stream(file, AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0);
  AVCodecContext* decoder = avcodec_alloc_context3(codec);
  avcodec_parameters_to_context(decoder, file->streams[stream]->codecpar);
  avcodec_open2(decoder, codec, nullptr);
  AVPacket* packet = av_packet_alloc();
  AVFrame* frame = av_frame_alloc();
  const auto take = [&] {
    while (avcodec_receive_frame(decoder, frame) == 0) {
      double sum = 0;
      for (int y = 0; y < frame->height; ++y)
        for (int x = 0; x < frame->width; ++x) sum += frame->data[0][y * frame->linesize[0] + x];
      shown.brightness.push_back(sum / (frame->width * frame->height));
      shown.times.push_back(static_cast<double>(frame->best_effort_timestamp) *
                            av_q2d(file->streams[stream]->time_base));
    }
  };
  while (av_read_frame(file, packet) >= 0) {
    avcodec_send_packet(decoder, packet);
    take();
    av_packet_unref(packet);
  }
  avcodec_send_packet(decoder, nullptr);
  take();
  av_frame_free(&frame);
  av_packet_free(&packet);
  avcodec_free_context(&decoder);
  avformat_close_input(&file);
  return shown;
}

TEST_F(Export, SamplesInEveryLayout) {
  const Answer robomimic =
      run("prehend recording export " + samples + " --format robomimic -o sets/all.hdf5");
  EXPECT_EQ(robomimic.code, 0) << robomimic.complaint;
  EXPECT_THAT(robomimic.output, HasSubstr("sets/all.hdf5: 2 episodes ("));
  EXPECT_THAT(robomimic.output, HasSubstr("left out, since not every episode has it: camera"));
  EXPECT_EQ(read(scratch_ / "sets/all.hdf5").substr(1, 3), "HDF");

  EXPECT_EQ(run("prehend recording export " + samples + " --format aloha -o aloha/").code, 0);
  EXPECT_TRUE(there("aloha/episode_0.hdf5"));
  EXPECT_TRUE(there("aloha/episode_1.hdf5"));
  EXPECT_FALSE(there("aloha/episode_2.hdf5"));

  EXPECT_EQ(run("prehend recording export " + samples + " --format lerobot -o new").code, 0);
  EXPECT_EQ(json("new/meta/info.json")["total_episodes"], 2);
  EXPECT_TRUE(json("new/meta/info.json")["video_path"].is_null());
  EXPECT_TRUE(there("new/data/chunk-000/file-000.parquet"));

  EXPECT_EQ(run("prehend recording export " + samples + " --format lerobot-v2.1 -o old").code, 0);
  EXPECT_EQ(json("old/meta/info.json")["codebase_version"], "v2.1");
  EXPECT_EQ(json("old/meta/info.json")["total_frames"], json("new/meta/info.json")["total_frames"]);
  EXPECT_TRUE(there("old/data/chunk-000/episode_000001.parquet"));
}

TEST_F(Export, VideosHaveAPictureForEveryRow) {
  ASSERT_EQ(
      run("prehend recording export " + with_pictures + " --format lerobot --rate 20 -o one").code,
      0);
  const Json info = json("one/meta/info.json");
  const Shown shown =
      decode(scratch_ / "one/videos/observation.images.camera/chunk-000/file-000.mp4");
  ASSERT_EQ(shown.times.size(), info["total_frames"].get<std::size_t>());
  ASSERT_GT(shown.times.size(), 50u);
  for (std::size_t i = 0; i < shown.times.size(); ++i)
    EXPECT_NEAR(shown.times[i], static_cast<double>(i) / 20, 1e-4);  // as near as LeRobot wants it

  // Brightness as the statistics of the same pictures say it (of full range, and of H.264's).
  const Json stats = json("one/meta/stats.json")["observation.images.camera"]["mean"];
  const double luma = 0.299 * stats[0][0][0].get<double>() + 0.587 * stats[1][0][0].get<double>() +
                      0.114 * stats[2][0][0].get<double>();
  double mean = 0;
  for (const double each : shown.brightness) mean += each / static_cast<double>(shown.times.size());
  EXPECT_NEAR((mean - 16) / 219, luma, 0.03);
}

TEST_F(Export, SeveralEpisodesOfPicturesShareAFile) {
  ASSERT_EQ(run("cp " + with_pictures +
                " a.mcap && cp a.mcap b.mcap && "
                "prehend recording export a.mcap b.mcap --format lerobot --size 64x48 -o two")
                .code,
            0);
  const Json info = json("two/meta/info.json");
  EXPECT_EQ(info["total_episodes"], 2);
  EXPECT_EQ(info["features"]["observation.images.camera"]["shape"], Json({48, 64, 3}));
  const Shown shown =
      decode(scratch_ / "two/videos/observation.images.camera/chunk-000/file-000.mp4");
  EXPECT_EQ(shown.times.size(), info["total_frames"].get<std::size_t>());
}

TEST_F(Export, TheTasksWordsAreThoseThatAreGiven) {
  ASSERT_EQ(run("prehend recording export " + samples +
                " --format lerobot-v2.1 --task 'Pick it up' -o said")
                .code,
            0);
  EXPECT_EQ(read(scratch_ / "said/meta/tasks.jsonl"),
            "{\"task_index\":0,\"task\":\"Pick it up\"}\n");
}

TEST_F(Export, WhatCannotBeMeantIsRefused) {
  refused(with_pictures + " --format aloha --rate 0", 2, "--rate 0: out of range (1 to 1000 Hz)");
  refused(with_pictures + " --format aloha --rate 5000", 2, "out of range");
  refused(with_pictures + " --format lerobot --rate 29.97", 2, "whole rows");
  refused(with_pictures + " --format aloha --hand left,left", 2, "must name each hand once");
  refused(with_pictures + " --format aloha --size 84", 2, "--size 84: is no size of pictures");
  refused(with_pictures + " --format aloha --hand left", 2, "holds no hand left but hand");
  refused(with_pictures + " --format zarr", 2, "--format");
  refused("nothing.mcap --format aloha", 3, "nothing.mcap: is not there");
  refused(test::in_sources("README.md --format robomimic"), 1, "README.md");
  refused(test::in_sources("docs/results --format robomimic"), 1, "holds no recording");
  const Answer without = run("prehend recording export " + with_pictures + " --format aloha");
  EXPECT_EQ(without.code, 2);
  EXPECT_THAT(without.complaint, HasSubstr("give the output with -o PATH"));
}

TEST_F(Export, ARecordingWithoutCommandsIsRefused) {
  ASSERT_EQ(run("prehend recording cut " + with_pictures + " --topic 'object/*' -o mute.mcap").code,
            0);
  refused("mute.mcap --format lerobot", 1, "mute.mcap: holds no command of a hand");
  // Among others it is passed by, and said.
  const Answer among =
      run("prehend recording export mute.mcap " + with_pictures + " --format lerobot -o kept");
  EXPECT_EQ(among.code, 1);
  EXPECT_THAT(among.complaint, HasSubstr("mute.mcap: holds no command of a hand"));
  EXPECT_THAT(among.output, HasSubstr("kept: 1 episode"));
}

TEST_F(Export, NothingIsOverwritten) {
  ASSERT_EQ(run("mkdir taken && echo mine > taken/mine").code, 0);
  for (const char* format : {"robomimic", "aloha", "lerobot", "lerobot-v2.1"}) {
    const Answer answer =
        run("prehend recording export " + with_pictures + " --format " + format + " -o taken");
    EXPECT_EQ(answer.code, 2);
    EXPECT_EQ(lines(answer), 1);
    EXPECT_THAT(answer.complaint, HasSubstr("taken: is there already"));
  }
  EXPECT_EQ(read(scratch_ / "taken/mine"), "mine\n");
}

// What is readable of a recording that was cut off is exported, and the loss is said.
TEST_F(Export, ADamagedRecordingIsExportedAsFarAsItGoes) {
  auto bytes = testing::file_bytes(with_pictures);
  bytes.resize(bytes.size() * 2 / 3);
  testing::write_bytes(scratch_ / "cut.mcap", bytes);
  const Answer cut = run("prehend recording export cut.mcap --format lerobot -o cut");
  EXPECT_EQ(cut.code, 1);
  EXPECT_THAT(cut.complaint, HasSubstr("cut.mcap"));
  EXPECT_GT(json("cut/meta/info.json")["total_frames"], 30);

  bytes.resize(100);
  testing::write_bytes(scratch_ / "stub.mcap", bytes);
  refused("stub.mcap --format lerobot", 1, "stub.mcap");
}

}  // namespace
}  // namespace prehend
