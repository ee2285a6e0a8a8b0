// Shards of the grasp benchmark as files: what was saved is read again to the last bit, and only
// what belongs together is merged. Trials are made up; that real ones come to the same as one run
// is the business of study_test.cpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <limits>

#include "common/base/file_text.hpp"
#include "common/proto/benchmark_shard.pb.h"
#include "common/proto/sealed_file.hpp"
#include "services/mapping/tools/judging/benchmark_shard.hpp"
#include "services/mapping/tools/judging/benchmark_summary.hpp"

namespace prehend::mapping {
namespace {

namespace fs = std::filesystem;

class Shards : public testing::Test {
 protected:
  Shards() : folder_(fs::path(testing::TempDir()) / ("shards" + std::to_string(getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~Shards() override { fs::remove_all(folder_); }

  fs::path saved(const BenchmarkShard& shard, const std::string& name) {
    EXPECT_TRUE(save_shard(folder_ / name, shard));
    return folder_ / name;
  }

  fs::path folder_;
};

TrialResult trial(int stage, int take) {
  TrialResult result;
  result.hand = "barrett";
  result.object = "Uncle Ben's, \"large\"";
  result.grasp_type = "power wrap";
  result.user = "test person 7";
  result.take = take;
  result.mode = {stage == 0 ? BenchmarkMode::direct : BenchmarkMode::intelligent, stage == 1};
  result.demonstrated_held = take % 2 == 0;
  result.joint_error = 1. / 3 + take;
  result.fingertip_error = std::numeric_limits<double>::denorm_min();
  result.epsilon = -1;
  result.penetration = 0.1 * stage;
  result.held = take % 3 == 0;
  result.reason = result.held ? "" : "slipped";
  return result;
}

/// Of two modes with six takes; take 5 has no person.
BenchmarkShard shard(int index, int count, const std::string& seed = "1") {
  BenchmarkShard made{{{"commit", "abc"}, {"seed", seed}}, {index, count}, 0, {}};
  for (int stage = 0; stage < 2; ++stage)
    for (int take = 0; take < 6; ++take) {
      if (!made.number.has(take)) continue;
      ++made.pieces;
      made.done.push_back({stage, take, {}});
      if (take != 5) made.done.back().result = trial(stage, take);
    }
  return made;
}

TEST_F(Shards, AreReadAsTheyWereSavedInWhateverOrderTheirTakesCame) {
  const BenchmarkShard one = shard(1, 1);
  BenchmarkShard reversed = one;
  std::reverse(reversed.done.begin(), reversed.done.end());
  const auto file = saved(one, "a.shard"), other = saved(reversed, "b.shard");
  EXPECT_EQ(read_file(file).value(), read_file(other).value());
  const auto read = load_shard(file);
  ASSERT_TRUE(read) << read.error().message();
  EXPECT_EQ(read->settings, one.settings);
  EXPECT_TRUE(read->is_complete());
  EXPECT_TRUE(read->has(1, 5));
  EXPECT_FALSE(read->done.back().result);
  EXPECT_EQ(read->done.front().result->joint_error, one.done.front().result->joint_error);
  EXPECT_EQ(read->done.front().result->fingertip_error, std::numeric_limits<double>::denorm_min());
}

TEST_F(Shards, ComeToWhatOneRunGives) {
  const auto one = merge_shards({saved(shard(1, 1), "one.shard")});
  ASSERT_TRUE(one) << one.error().message();
  EXPECT_EQ(one->trials.size(), 10u);
  const auto merged = merge_shards({saved(shard(3, 4), "3.shard"), saved(shard(1, 4), "1.shard"),
                                    saved(shard(4, 4), "4.shard"), saved(shard(2, 4), "2.shard")});
  ASSERT_TRUE(merged) << merged.error().message();
  EXPECT_EQ(to_csv(merged->trials), to_csv(one->trials));
  EXPECT_EQ(to_rows(summarise(merged->trials)), to_rows(summarise(one->trials)));
}

TEST_F(Shards, AreRefusedWhereOneIsMissingDoubledForeignOrNotDone) {
  const auto first = saved(shard(1, 3), "1.shard"), second = saved(shard(2, 3), "2.shard"),
             third = saved(shard(3, 3), "3.shard"), foreign = saved(shard(3, 3, "2"), "f.shard"),
             twin = saved(shard(2, 3), "twin.shard"), finer = saved(shard(3, 4), "finer.shard");
  BenchmarkShard half = shard(3, 3);
  half.done.pop_back();
  const auto broken_off = saved(half, "half.shard");
  const auto refusal = [](const std::vector<fs::path>& files) {
    const auto merged = merge_shards(files);
    return merged ? "" : merged.error().message();
  };
  EXPECT_EQ(refusal({first, second, third}), "");
  const std::string folder = folder_.string();
  EXPECT_EQ(refusal({first, third}), folder + ": shard 2/3 is missing (run it, or name its file)");
  EXPECT_EQ(
      refusal({first, second, twin, third}),
      twin.string() + ": shard 2/3 is there twice (leave out this one or " + second.string() + ")");
  EXPECT_EQ(refusal({first, second, foreign}),
            foreign.string() + ": is of another benchmark: seed 2, not 1 (compared with " +
                first.string() + ")");
  EXPECT_EQ(refusal({first, second, finer}),
            finer.string() + ": is shard 3/4, not one of 3 (compared with " + first.string() + ")");
  EXPECT_EQ(refusal({first, second, broken_off}),
            broken_off.string() +
                ": shard 3/3 is not done: 3 of 4 takes (run it again; it goes on there)");
}

TEST_F(Shards, SayHowFarTheyAre) {
  BenchmarkShard half = shard(3, 3);
  half.done.pop_back();
  saved(shard(1, 3), "shard-1-of-3.shard");
  saved(half, "shard-3-of-3.shard");
  const auto progress = shard_progress(folder_);
  ASSERT_TRUE(progress) << progress.error().message();
  ASSERT_EQ(progress->size(), 3u);
  EXPECT_EQ((*progress)[0].done, 4u);
  EXPECT_TRUE((*progress)[0].is_complete());
  EXPECT_FALSE((*progress)[1].begun);
  EXPECT_FALSE((*progress)[1].is_complete());
  EXPECT_EQ((*progress)[2].done, 3u);
  EXPECT_EQ((*progress)[2].pieces, 4u);
  saved(shard(2, 3, "2"), "shard-2-of-3.shard");
  EXPECT_FALSE(shard_progress(folder_));
  EXPECT_FALSE(shard_progress(folder_ / "nowhere"));
}

TEST_F(Shards, AreRefusedWhenTheyAreDamagedOrContradictThemselves) {
  const auto file = saved(shard(1, 2), "a.shard");
  std::string bytes = read_file(file).value();
  bytes[bytes.size() / 2] ^= 1;
  ASSERT_TRUE(write_file(file, bytes));
  const auto damaged = load_shard(file);
  ASSERT_FALSE(damaged);
  EXPECT_NE(damaged.error().message().find("digest"), std::string::npos);
  BenchmarkShard others = shard(1, 2);
  others.number.index = 2;
  EXPECT_FALSE(load_shard(saved(others, "b.shard"))) << "takes of another shard";
  BenchmarkShard twice = shard(1, 2);
  twice.done.back() = twice.done.front();
  EXPECT_FALSE(load_shard(saved(twice, "c.shard"))) << "a take is there twice";
}

TEST_F(Shards, AreRefusedWhereTheyAreNoneOrFew) {
  const auto odd = folder_ / "odd.shard";
  ASSERT_TRUE(proto::write_sealed(odd, "benchmark-shard", "\xff"));
  EXPECT_EQ(load_shard(odd).error().message(),
            odd.string() + ": holds no shard (run this shard again)");
  messages::BenchmarkShard message;
  message.add_trials()->set_mode("telepathy");
  ASSERT_TRUE(proto::write_sealed(odd, "benchmark-shard", message.SerializeAsString()));
  EXPECT_EQ(load_shard(odd).error().what, "knows a mode that is none");
  EXPECT_EQ(merge_shards({}).error().message(), "--merge: names no shard");
  fs::remove(odd);
  EXPECT_EQ(shard_progress(folder_).error().message(),
            folder_.string() + ": holds no shards (has none begun?)");
  saved(shard(1, 3), "1.shard");
  saved(shard(2, 4), "2.shard");
  EXPECT_THAT(shard_progress(folder_).error().message(),
              testing::HasSubstr("2.shard: is shard 2/4, not one of 3 (compared with "));
}

TEST(ShardNumber, IsReadFromText) {
  EXPECT_EQ(parse_shard("2/4")->index, 2);
  EXPECT_EQ(parse_shard("2/4")->count, 4);
  for (const char* text : {"", "2", "0/4", "5/4", "2/", "/4", "2/4x", "-1/4", "2/0", "1/9999999"})
    EXPECT_FALSE(parse_shard(text)) << text;
}

}  // namespace
}  // namespace prehend::mapping
