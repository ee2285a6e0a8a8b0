// A recording plays by itself, and as clients ask.
#include "services/console/service/film.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <map>

#include "common/dds/topics.hpp"
#include "common/recording/mcap/writer.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::console {
namespace {

constexpr Duration tick = std::chrono::milliseconds(20);

class FilmTest : public testing::Test {
 protected:
  FilmTest() {
    film_->letters(now_);
    film_->news(now_);
  }
  /// What is said in this time.
  std::vector<Letter> pass(Duration time) {
    std::vector<Letter> all;
    for (const Time end = now_ + time; now_ < end;) {
      now_ += tick;
      for (Letter& letter : film_->letters(now_)) all.push_back(std::move(letter));
    }
    return all;
  }
  double at() const { return to_seconds(film_->time() - from_ns(film_->span().begin_ns)); }
  double length() const { return 1e-9 * (film_->span().end_ns - film_->span().begin_ns); }
  std::int64_t after(double s) const { return film_->span().begin_ns + to_ns(Time(seconds(s))); }

  std::unique_ptr<Film> film_ =
      Film::open(test::in_sources("deploy/samples/intelligent-grasp.mcap")).value();
  Time now_ = from_ns(1'000'000'000'000);
};

// A sound file, but of somebody else.
TEST(Film, NeedsAMessageOfALab) {
  const auto file = std::filesystem::path(::testing::TempDir()) /
                    ("weather" + std::to_string(::getpid()) + ".mcap");
  {
    auto writer = recording::mcap::Writer::create(file).value();
    const auto channel = writer.add_channel(0, "weather", "cdr").value();
    ASSERT_TRUE(writer.write(recording::mcap::Message{channel, 1, 5, 5, {}}));
  }
  EXPECT_EQ(Film::open(file).error().message(),
            file.string() + ": holds no message of a lab (see prehend recording info FILE)");
  std::filesystem::remove(file);
}

bool is_queued(const Letter& letter) {
  return dds::topic_table[letter.topic].qos.reader_depth == 0;
}

TEST_F(FilmTest, PlaysAtItsSpeed) {
  ASSERT_GT(length(), 3);
  EXPECT_FALSE(pass(seconds(1)).empty());
  EXPECT_NEAR(at(), 1, 1e-9);
  film_->obey({.play = true, .speed = 0.5});
  pass(seconds(1));
  EXPECT_NEAR(at(), 1.5, 1e-9);
  film_->obey({.play = false});
  EXPECT_TRUE(pass(seconds(1)).empty());
  EXPECT_EQ(film_->news(now_)->status, PlaybackState::Status::paused);
}

// As if somebody had watched until then: of each instance the newest, of what counts all.
TEST_F(FilmTest, ShowsAtOnceWhatIsSoAtATime) {
  std::map<std::pair<std::size_t, dds::Guid>, std::int64_t> newest;
  std::size_t queued = 0;
  film_->obey({.play = false, .seek_ns = after(0)});
  auto heard = pass(tick);
  film_->obey({.play = true});
  for (Letter& letter : pass(seconds(2))) heard.push_back(std::move(letter));
  for (const Letter& letter : heard) {
    if (is_queued(letter))
      ++queued;
    else if (letter.payload)
      newest[{letter.topic, letter.instance}] = letter.sent_ns;
    else
      newest.erase({letter.topic, letter.instance});
  }
  film_->obey({.play = false, .speed = 1, .seek_ns = after(at()), .id = "7"});
  const auto shown = pass(tick);
  for (const Letter& letter : shown) {
    if (is_queued(letter)) {
      --queued;
      continue;
    }
    ASSERT_TRUE(newest.contains({letter.topic, letter.instance}));
    EXPECT_EQ(letter.sent_ns, newest.at({letter.topic, letter.instance}));
    newest.erase({letter.topic, letter.instance});
  }
  EXPECT_EQ(queued, 0U);
  EXPECT_TRUE(newest.empty());
  const auto news = film_->news(now_);
  ASSERT_TRUE(news);
  EXPECT_TRUE(news->sought);
  EXPECT_EQ(news->id, "7");
  EXPECT_FALSE(film_->news(now_)) << "nothing new";
}

TEST_F(FilmTest, BeginsAnewAfterItsEnd) {
  film_->obey({.play = true, .seek_ns = film_->span().end_ns + 5});
  pass(tick);
  EXPECT_EQ(film_->news(now_)->status, PlaybackState::Status::ended);
  pass(seconds(1.5));
  EXPECT_NEAR(at(), length(), 1e-6);
  pass(seconds(1.5));
  EXPECT_LT(at(), 1.1);
  EXPECT_TRUE(film_->news(now_)->sought);
}

TEST_F(FilmTest, PausedAtItsEndItStaysThereAndSaysSo) {
  film_->obey({.play = true, .seek_ns = film_->span().end_ns});
  pass(tick);
  film_->obey({.play = false});
  EXPECT_TRUE(pass(seconds(3)).empty());
  EXPECT_EQ(film_->news(now_)->status, PlaybackState::Status::paused);
  EXPECT_NEAR(at(), length(), 1e-6);
  film_->obey({.play = true});
  pass(seconds(0.5));
  EXPECT_LT(at(), 0.6) << "from the beginning";
  EXPECT_EQ(film_->news(now_)->status, PlaybackState::Status::playing);
}

}  // namespace
}  // namespace prehend::console
