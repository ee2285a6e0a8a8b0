// Recordings of others: where episodes begin and end, what is in their rows, and in which part each
// of them is.
#include "services/recorder/core/dataset/mapped_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "services/recorder/core/dataset/split.hpp"

namespace prehend::recorder::dataset {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Time at_ms(int t) {
  return from_ns(1'700'000'000'000'000'000 + t * 1'000'000ll);
}

Track numbers(Role role, const std::string& name, const std::vector<int>& times) {
  Track track{name, role, {name + ".x"}, {}, {}};
  for (const int t : times) track.numbers.add(at_ms(t), Eigen::VectorXd::Constant(1, t / 1000.0));
  return track;
}

std::vector<int> each_20_ms(int from, int to) {
  std::vector<int> times;
  for (int t = from; t <= to; t += 20) times.push_back(t);
  return times;
}

MappedLog log_of(const std::vector<int>& actions) {
  MappedLog log;
  log.tracks = {numbers(Role::state, "state", each_20_ms(0, 4000)),
                numbers(Role::action, "action", actions)};
  return log;
}

std::vector<std::pair<int, int>> found(const MappedLog& log, const EpisodeRule& rule) {
  std::vector<std::pair<int, int>> all;
  for (const Episode& each : find_episodes(log, rule, at_ms(0)))
    all.emplace_back(static_cast<int>((each.begin - at_ms(0)).count() / 1'000'000),
                     static_cast<int>((each.end - at_ms(0)).count() / 1'000'000));
  return all;
}

TEST(MappedEpisodes, AreOneWithoutARule) {
  EXPECT_THAT(found(log_of(each_20_ms(100, 900)), {}), ElementsAre(std::pair(100, 900)));
  EXPECT_TRUE(found(log_of({}), {}).empty());
}

TEST(MappedEpisodes, ArePartedByGaps) {
  auto times = each_20_ms(0, 500);
  const auto more = each_20_ms(1600, 2000);
  times.insert(times.end(), more.begin(), more.end());
  EXPECT_THAT(found(log_of(times), {.gap = seconds(1.0)}),
              ElementsAre(std::pair(0, 500), std::pair(1600, 2000)));
  EXPECT_THAT(found(log_of(times), {.gap = seconds(1.2)}), ElementsAre(std::pair(0, 2000)));
}

TEST(MappedEpisodes, AreMarked) {
  MappedLog log = log_of(each_20_ms(0, 3000));
  log.marks = {{at_ms(200), false, true, {}},
               {at_ms(900), true, false, true},
               {at_ms(1000), true, false, {}},  // nothing was open
               {at_ms(1500), false, true, {}}};
  EXPECT_THAT(found(log, {}), ElementsAre(std::pair(200, 900), std::pair(1500, 3000)));
  EXPECT_EQ(find_episodes(log, {}, at_ms(0))[0].success, true);
  EXPECT_EQ(find_episodes(log, {}, at_ms(0))[1].success, std::nullopt);
  // Without a field each message ends one and begins the next.
  log.marks = {{at_ms(200)}, {at_ms(900)}};
  EXPECT_THAT(found(log, {}), ElementsAre(std::pair(200, 900), std::pair(900, 3000)));
  // What somebody gives counts before all.
  EXPECT_THAT(found(log, {.given = {{0.5, 1.25}}}), ElementsAre(std::pair(500, 1250)));
}

TEST(MappedRows, HoldWhatIsMappedAtItsTime) {
  MappedLog log = log_of(each_20_ms(0, 2000));
  Track pose{"tool", Role::observation, {"pose"}, {}, {}};
  for (const int t : each_20_ms(0, 2000)) {
    Pose X = Pose::Identity();
    X.translation().x() = t / 1000.0;
    pose.poses.add(at_ms(t), X);
  }
  log.tracks.push_back(pose);
  log.tracks.push_back(numbers(Role::state, "more", each_20_ms(0, 2000)));
  const auto rows = make_rows(log, {at_ms(110), at_ms(1110), "", "", {}}, {.rate = 10});
  ASSERT_TRUE(rows) << rows.error().message();
  EXPECT_EQ(rows->count, 11);
  EXPECT_THAT(rows->state.columns, ElementsAre("state.x", "more.x"));
  EXPECT_THAT(rows->action.columns, ElementsAre("action.x"));
  ASSERT_EQ(rows->others.size(), 1u);
  EXPECT_THAT(rows->others[0].columns, ElementsAre("pose.x", "pose.y", "pose.z", "pose.qw",
                                                   "pose.qx", "pose.qy", "pose.qz"));
  for (Eigen::Index row = 0; row < rows->count; ++row) {
    const double t = 0.11 + 0.1 * static_cast<double>(row);
    EXPECT_NEAR(rows->state.values(row, 0), t, 1e-9);
    EXPECT_NEAR(rows->state.values(row, 1), t, 1e-9);
    EXPECT_NEAR(rows->action.values(row, 0), t, 1e-9);
    EXPECT_NEAR(rows->others[0].values(row, 0), t, 1e-9);
    EXPECT_NEAR(rows->rate(row, 0), 1, 1e-6);
  }
}

TEST(MappedRows, BeginWhenAllHasBeenTold) {
  MappedLog log = log_of(each_20_ms(0, 2000));
  log.tracks.push_back(numbers(Role::observation, "late", each_20_ms(500, 2000)));
  const auto rows = make_rows(log, {at_ms(0), at_ms(2000), "", "", {}}, {.rate = 10});
  ASSERT_TRUE(rows);
  EXPECT_EQ(rows->begin, at_ms(500));
  const auto before = make_rows(log, {at_ms(0), at_ms(400), "", "", {}}, {.rate = 10});
  ASSERT_FALSE(before);
  EXPECT_THAT(before.error().what, HasSubstr("late is not told in an episode"));
  EXPECT_FALSE(make_rows(log, {at_ms(600), at_ms(610), "", "", {}}, {.rate = 10}));
  const auto endless = make_rows(log, {at_ms(600), at_ms(1'000'000'000), "", "", {}}, {.rate = 10});
  ASSERT_FALSE(endless);
  EXPECT_EQ(endless.error().message(),
            "an episode is of more than a million rows (are its times right?)");
}

TEST(Split, HasThePartsThatAreAskedFor) {
  const auto shares = parse_split("train=0.8,valid=0.2");
  ASSERT_TRUE(shares);
  for (const std::size_t count : {2u, 3u, 5u, 10u, 101u}) {
    const auto part = draw_split(*shares, count, 3);
    ASSERT_TRUE(part);
    const auto valid = std::ranges::count(*part, 1u);
    EXPECT_NEAR(static_cast<double>(valid), std::max(1.0, 0.2 * static_cast<double>(count)), 0.5)
        << count;
    EXPECT_EQ(*part, *draw_split(*shares, count, 3));
  }
  std::set<std::vector<std::size_t>> drawn;
  for (std::uint64_t seed = 0; seed < 20; ++seed) drawn.insert(*draw_split(*shares, 20, seed));
  EXPECT_GT(drawn.size(), 15u);
  EXPECT_THAT(draw_split(*shares, 1, 1).error().message(), HasSubstr("2 parts of 1 episodes"));
}

TEST(Split, SaysWhatIsNone) {
  for (const char* text :
       {"", "train", "train=", "train=x", "train=0.8", "train=0.5,train=0.5", "a/b=1",
        "train=nan,valid=0.2", "train=1.2,valid=-0.2", "train=1,", "success=1"})
    EXPECT_FALSE(parse_split(text)) << text;
  EXPECT_TRUE(parse_split("all=1"));
}

}  // namespace
}  // namespace prehend::recorder::dataset
