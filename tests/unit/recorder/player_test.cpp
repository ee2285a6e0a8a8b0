// A player with real DDS readers beside it, over recordings made for each case. What is published
// must be, byte for byte, what was recorded; orders decide which samples and when. No time is
// asserted: where speed matters, a recording is so long that only the order could have ended it.
//
// With stamps moved to now a stamp t becomes a + (t - t0) / rate for one a and t0 as long as nobody
// pauses: so at rate 1 all differences between stamps are exactly the recorded ones, and at rate 2
// half of them, rounded to a nanosecond.
#include "services/recorder/service/player.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "common/recording/types/idl.hpp"
#include "services/recorder/service/recording_file.hpp"
#include "tests/support/domains/domain_lease.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/recording/scratch.hpp"

namespace prehend::recorder {
namespace {

using dds::RawSample;
using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::int64_t begin_ns = 1'700'000'000'000'000'000;

Time system_now() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

/// Writes recordings: each sample `ms` after their common beginning.
class Writing {
 public:
  explicit Writing(const std::filesystem::path& path)
      : file_(RecordingFile::create(path, heading_, recording::mcap::Compression::lz4).value()) {}

  void report(std::uint64_t number, int ms, const std::string& hand = "hand") {
    v1::GraspReport report;
    report.hand(hand);
    report.sequence_number(number);
    report.stamp_ns(at(ms));
    report.origin_ns(at(ms) - 5'000'000);
    write(source(dds::grasp_report), dds::encode(dds::grasp_report, report), ms, 1);
  }
  void detection(std::uint32_t track, std::uint64_t number, int ms) {
    v1::ObjectDetection detection;
    detection.track(track);
    detection.sequence_number(number);
    detection.stamp_ns(at(ms));
    write(source(dds::object_detection), dds::encode(dds::object_detection, detection), ms,
          static_cast<std::uint8_t>(track));
  }
  void gone(std::uint32_t track, int ms) {
    write(source(dds::object_detection), {}, ms, static_cast<std::uint8_t>(track),
          RawSample::Kind::disposed);
  }
  void command(std::uint64_t number, int ms) {
    v2::HandCommand command;
    command.hand("hand");
    command.sequence_number(number);
    command.stamp_ns(at(ms));
    write(source(dds::robot_command), dds::encode(dds::robot_command, command), ms, 1);
  }
  void close() { ASSERT_TRUE(file_.close()); }
  static std::int64_t at(int ms) { return begin_ns + ms * 1'000'000ll; }

  /// What a sample is about, so that a test can say more of it.
  void write(const Source& source, std::vector<std::uint8_t> payload, int ms, std::uint8_t instance,
             RawSample::Kind kind = RawSample::Kind::data) {
    RawSample sample;
    sample.kind = kind;
    sample.payload = std::move(payload);
    sample.instance[15] = instance;
    sample.writer[0] = 7;
    sample.sequence = ++sequence_;
    sample.sent = sample.received = from_ns(at(ms));
    ASSERT_TRUE(file_.write(source, sample, sample.received));
  }
  const Source& source(const dds::TopicInfo& topic) {
    Source& source = sources_[std::string(topic.name)];
    source = {dds::raw_topic(topic), "lab"};
    return source;
  }

 private:
  Heading heading_{{}, "", [](const std::string&) { return std::nullopt; }};
  RecordingFile file_;
  std::map<std::string, Source> sources_;
  std::uint64_t sequence_ = 0;
};

/// Hears all that is played on one topic.
class Collector {
 public:
  Collector(dds::Participant& participant, const dds::RawTopic& topic) {
    reader_ = dds::RawReader::create(participant, topic, [this](RawSample&& sample) {
                const std::scoped_lock lock(mutex_);
                heard_.push_back(std::move(sample));
                news_.notify_all();
              }).value();
  }
  /// Waits until so many have come; fewer when they do not.
  std::vector<RawSample> wait(std::size_t count) {
    std::unique_lock lock(mutex_);
    news_.wait_for(lock, std::chrono::seconds(20), [&] { return heard_.size() >= count; });
    return heard_;
  }
  std::vector<std::uint64_t> numbers(std::size_t count) {
    std::vector<std::uint64_t> result;
    for (const RawSample& sample : wait(count)) {
      v1::GraspReport report;
      EXPECT_TRUE(dds::decode(dds::grasp_report, sample, report));
      result.push_back(report.sequence_number());
    }
    return result;
  }

 private:
  std::mutex mutex_;
  std::condition_variable news_;
  std::vector<RawSample> heard_;
  std::unique_ptr<dds::RawReader> reader_;
};

class PlayerTest : public ::testing::Test {
 protected:
  PlayerTest()
      : rig_("player-" + std::to_string(::getpid()) + "-" + std::to_string(to_ns(system_now()))),
        stage_(join(nullptr)),
        hall_(join(&discovery_)) {}

  dds::Participant join(dds::Discovery* listener) {
    return dds::Participant::create({.name = "player test",
                                     .domain = lease_.domain(),
                                     .rig = rig_,
                                     .listener = listener})
        .value();
  }
  Collector collect(const dds::TopicInfo& topic) { return Collector(hall_, dds::raw_topic(topic)); }
  /// Reports have all been heard however late a reader is: their topic keeps all.
  Collector reports(const std::string& topic = "grasp/report") {
    dds::RawTopic raw = dds::raw_topic(dds::grasp_report);
    raw.name = topic;
    return Collector(hall_, raw);
  }
  /// `count` reports, one every `step` ms.
  std::filesystem::path tape_of_reports(int count, int step) {
    const auto path = scratch_ / "reports.mcap";
    Writing writing(path);
    for (int i = 0; i < count; ++i) writing.report(static_cast<std::uint64_t>(i), i * step);
    writing.close();
    return path;
  }
  std::unique_ptr<Player> player(
      const std::filesystem::path& path, PlayerOptions options = {},
      const Tape::Wanted& wanted = [](const std::string&) { return true; }) {
    auto made = Player::create(Tape::open({path}, wanted).value(), stage_, types_, options);
    EXPECT_TRUE(made) << made.error().message();
    return std::move(*made);
  }
  std::jthread run(Player& player, Duration delay = {}) {
    return std::jthread([&player, start = system_now() + delay](const std::stop_token& stop) {
      player.play(stop, start);
    });
  }
  /// Waits for the end of what was played.
  static void end(Player& player) {
    const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!player.stats().ended && std::chrono::steady_clock::now() < limit)
      std::this_thread::sleep_for(milliseconds(2));
    EXPECT_TRUE(player.stats().ended);
  }

  const testing::Scratch scratch_;
  const test::DomainLease lease_;
  const std::string rig_;
  const recording::types::Library types_ =
      recording::types::load_idl(test::in_sources("idl")).value();
  std::mutex mutex_;
  std::map<std::string, dds::TopicQos> offered_;  // by the player's writers
  dds::Discovery discovery_{[this](const dds::DiscoveredWriter& found) {
    const std::scoped_lock lock(mutex_);
    if (!found.gone) offered_[found.topic.name] = found.topic.qos;
  }};
  dds::Participant stage_, hall_;
};

TEST_F(PlayerTest, PlaysBytesKeysEndsAndStampsAsRecorded) {
  const auto path = scratch_ / "a.mcap";
  Writing writing(path);
  for (int i = 0; i < 30; ++i) writing.report(i, i, i % 2 ? "left" : "right");
  for (std::uint32_t i = 0; i < 10; ++i) writing.detection(i % 2, i, 30 + static_cast<int>(i));
  writing.gone(1, 41);
  writing.close();
  Collector reports = this->reports(), detections = collect(dds::object_detection);
  auto player = this->player(path);
  const auto thread = run(*player, milliseconds(500));
  end(*player);
  std::map<std::string, std::vector<RawSample>> heard{{"grasp/report", reports.wait(30)},
                                                      {"object/detection", detections.wait(11)}};
  auto tape = Tape::open({path}, [](const std::string&) { return true; }).value();
  std::map<std::string, std::size_t> count;
  while (const auto played = tape.next()) {
    const std::string& topic = played->stream->topic.name;
    ASSERT_LT(count[topic], heard[topic].size()) << topic;
    const RawSample& sample = heard[topic][count[topic]++];
    EXPECT_EQ(sample.kind, played->sample.kind);
    EXPECT_EQ(sample.payload, played->sample.payload);
    EXPECT_EQ(sample.instance, played->sample.instance);
    EXPECT_EQ(sample.sent, played->sample.sent);
  }
  EXPECT_EQ(count["grasp/report"], 30u);
  EXPECT_EQ(count["object/detection"], 11u);
  for (const char* topic : {"grasp/report", "object/detection"})
    EXPECT_EQ(recording::to_text(offered_[topic]), recording::to_text(dds::find_topic(topic)->qos));
}

// Writers of robot/command let samples die 200 ms after their source time stamp. A recording of
// another day would be dead at once: the ordinary reader of a robot must get it all the same.
TEST_F(PlayerTest, OldCommandsReachARobotWithTheirStamps) {
  const auto path = scratch_ / "a.mcap";
  Writing writing(path);
  for (int i = 0; i < 20; ++i) writing.command(i, 5 * i);
  writing.close();
  auto robot = hall_.reader(dds::robot_command).value();
  auto player = this->player(path);
  const auto thread = run(*player, milliseconds(500));
  std::set<std::uint64_t> numbers;
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!numbers.contains(19) && std::chrono::steady_clock::now() < limit) {
    robot.raw().wait_for_unread_message({0, 10'000'000});
    for (const auto& sample : robot.take()) {
      if (sample.info.gone) continue;
      numbers.insert(sample.data.sequence_number());
      EXPECT_EQ(to_ns(sample.info.sent), sample.data.stamp_ns());
    }
  }
  EXPECT_TRUE(numbers.contains(19)) << numbers.size();
  EXPECT_EQ(recording::to_text(offered_["robot/command"]),
            recording::to_text(dds::robot_command.qos));
}

// A command was once without effort, which is now the sequence at its end.
TEST_F(PlayerTest, CommandsOfTheVersionBeforeAreReadAsThoseOfNow) {
  const auto path = scratch_ / "a.mcap";
  Writing writing(path);
  Source source = writing.source(dds::robot_command);
  source.topic.type = "prehend::v1::HandCommand";
  v2::HandCommand command;
  command.model("barrett");
  command.dof({0.1, 0.2, 0.3});
  command.extrapolating(true);
  for (int i = 0; i < 8; ++i) {
    command.hand(std::string(static_cast<std::size_t>(i), 'h'));
    command.object(std::string(static_cast<std::size_t>(i), 'o'));
    std::vector<std::uint8_t> payload = dds::encode(dds::robot_command, command);
    payload.resize(payload.size() - 4);
    if (i % 2 == 0)  // a writer may leave the padding at the end out
      while (payload.back() == 0) payload.pop_back();
    writing.write(source, payload, i, 1);
  }
  writing.close();
  auto tape = Tape::open({path}, [](const std::string&) { return true; }).value();
  EXPECT_EQ(tape.streams().front()->topic.type, dds::robot_command.type_name());
  for (int i = 0; i < 8; ++i) {
    const auto played = tape.next();
    ASSERT_TRUE(played);
    command.hand(std::string(static_cast<std::size_t>(i), 'h'));
    command.object(std::string(static_cast<std::size_t>(i), 'o'));
    v2::HandCommand read;
    ASSERT_TRUE(dds::decode(dds::robot_command, played->sample, read));
    EXPECT_EQ(read, command);
  }
}

TEST_F(PlayerTest, StampsOfNowKeepTheirDistances) {
  const auto path = tape_of_reports(40, 7);
  for (const double rate : {1.0, 2.0}) {
    const std::string topic = fmt::format("report/{}", rate);
    Collector collector = reports(topic);
    const Time before = system_now();
    auto player =
        this->player(path, {.rate = rate, .stamps_now = true, .remap = {{"grasp/report", topic}}});
    const auto thread = run(*player);
    const auto heard = collector.wait(40);
    const Time after = system_now();
    ASSERT_EQ(heard.size(), 40u);
    std::optional<std::int64_t> first;
    for (int i = 0; i < 40; ++i) {
      v1::GraspReport report;
      ASSERT_TRUE(dds::decode(dds::grasp_report, heard[i], report));
      first = first.value_or(report.stamp_ns());
      const std::int64_t wanted = *first + std::llround(static_cast<double>(i) * 7'000'000 / rate);
      EXPECT_LE(std::abs(report.stamp_ns() - wanted), rate == 1 ? 0 : 1);
      EXPECT_LE(std::abs(report.stamp_ns() - report.origin_ns() - std::llround(5'000'000 / rate)),
                rate == 1 ? 0 : 1);
      // Beside the message too, where the transport has fractions of 2^-32 s.
      EXPECT_LE(std::abs(to_ns(heard[i].sent) - report.stamp_ns()), 1);
      EXPECT_GE(report.stamp_ns(), to_ns(before));
      EXPECT_LE(report.stamp_ns(), to_ns(after));
    }
    end(*player);
  }
}

TEST_F(PlayerTest, ImpossibleStampsAreLeftAlone) {
  const auto path = scratch_ / "a.mcap";
  Writing writing(path);
  const std::vector<std::int64_t> stamps{std::numeric_limits<std::int64_t>::max(),
                                         std::numeric_limits<std::int64_t>::min(), -1, 1};
  for (const std::int64_t stamp : stamps) {
    v1::GraspReport report;
    report.hand("hand");
    report.stamp_ns(stamp);
    writing.write(writing.source(dds::grasp_report), dds::encode(dds::grasp_report, report), 0, 1);
  }
  writing.close();
  Collector collector = reports();
  auto player = this->player(path, {.rate = 0.01, .stamps_now = true});
  const auto thread = run(*player);
  const auto heard = collector.wait(stamps.size());
  ASSERT_EQ(heard.size(), stamps.size());
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    v1::GraspReport report;
    ASSERT_TRUE(dds::decode(dds::grasp_report, heard[i], report));
    EXPECT_EQ(report.stamp_ns(), stamps[i]);
  }
}

TEST_F(PlayerTest, PlaysTopicsUnderOtherNamesAndQos) {
  const auto path = tape_of_reports(5, 1);
  Collector other = reports("trial/report"), own = reports();
  auto player = this->player(path, {.remap = {{"grasp/report", "trial/report"}},
                                    .qos = {{"grasp/*", "best_effort deadline_ms=300"},
                                            {"grasp/rep*", "reliable deadline_ms=400"},
                                            {"trial/*", "exclusive"}}});
  const auto thread = run(*player);
  EXPECT_THAT(other.numbers(5), ElementsAre(0, 1, 2, 3, 4));
  end(*player);
  EXPECT_TRUE(own.wait(0).empty());
  // What the override does not say is as recorded; of several the last one counts.
  EXPECT_EQ(recording::to_text(offered_["trial/report"]),
            "reliable transient_local keep_last=1 deadline_ms=400");
  const auto refused =
      Player::create(Tape::open({path}, [](const std::string&) { return true; }).value(), stage_,
                     types_, {.qos = {{"*", "fast"}}});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message(), HasSubstr("fast"));
}

TEST_F(PlayerTest, PlaysOnlyWantedTopics) {
  const auto path = scratch_ / "a.mcap";
  Writing writing(path);
  for (int i = 0; i < 4; ++i) writing.report(i, i), writing.detection(1, i, i);
  writing.close();
  Collector reports = this->reports();
  auto player =
      this->player(path, {}, [](const std::string& topic) { return topic == "grasp/report"; });
  const auto thread = run(*player);
  EXPECT_THAT(reports.numbers(4), ElementsAre(0, 1, 2, 3));
  end(*player);
  EXPECT_EQ(player->stats().published, 4u);
  EXPECT_FALSE(offered_.contains("object/detection"));
}

TEST_F(PlayerTest, ARangeBeginsWithWhatStandsThere) {
  const auto path = scratch_ / "a.mcap";
  Writing writing(path);
  writing.detection(1, 10, 0);
  writing.detection(1, 11, 5);
  writing.detection(2, 20, 6);
  writing.gone(2, 7);
  for (int i = 0; i < 10; ++i) writing.report(i, 10 * i);
  writing.close();
  Collector reports = this->reports(), detections = collect(dds::object_detection);
  auto player =
      this->player(path, {.from = from_ns(Writing::at(30)), .to = from_ns(Writing::at(60))});
  const auto thread = run(*player);
  end(*player);
  // Of reports all before are kept, of detections the last one of those that live.
  EXPECT_THAT(reports.numbers(7), ElementsAre(0, 1, 2, 3, 4, 5, 6));
  const auto standing = detections.wait(1);
  ASSERT_EQ(standing.size(), 1u);
  v1::ObjectDetection detection;
  ASSERT_TRUE(dds::decode(dds::object_detection, standing[0], detection));
  EXPECT_EQ(detection.sequence_number(), 11u);
  const auto empty =
      Player::create(Tape::open({path}, [](const std::string&) { return true; }).value(), stage_,
                     types_, {.from = from_ns(Writing::at(5000))});
  EXPECT_FALSE(empty);
}

TEST_F(PlayerTest, LoopsUntilItIsTold) {
  const auto path = tape_of_reports(3, 2);
  Collector collector = reports();
  auto player = this->player(path, {.loop = true});
  const auto thread = run(*player);
  const auto three_rounds = collector.numbers(9);
  EXPECT_TRUE(player->stats().loops);
  ASSERT_TRUE(player->execute("loop off"));
  end(*player);
  ASSERT_GE(three_rounds.size(), 9u);
  const auto all = collector.numbers(9);
  EXPECT_EQ(all.size() % 3, 0u);
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i], i % 3);
  EXPECT_EQ(player->stats().rounds + 1, all.size() / 3);
}

/// The player's state as soon as it says `what`; what it says at last when it never does.
std::string state_once(Player& player, const std::string& what) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  for (;;) {
    const std::string state = player.execute("state").value();
    if (state.find(what) != std::string::npos || std::chrono::steady_clock::now() > end)
      return state;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

TEST_F(PlayerTest, StepsAndPlaysBursts) {
  const auto path = tape_of_reports(10, 1);
  Collector collector = reports();
  auto player = this->player(path, {.paused = true});
  const auto thread = run(*player);
  ASSERT_TRUE(player->execute("step"));
  EXPECT_THAT(collector.numbers(1), ElementsAre(0));
  ASSERT_TRUE(player->execute("burst 3"));
  EXPECT_THAT(collector.numbers(4), ElementsAre(0, 1, 2, 3));
  // A reader in this process hears a message before the player has counted it.
  EXPECT_THAT(state_once(*player, "4 messages"),
              HasSubstr("paused at 0.003 of 0.009 s, rate 1, 4 messages"));
  // A burst over the end is what is left, and it stays there: somebody may seek.
  ASSERT_TRUE(player->execute("burst 100"));
  EXPECT_EQ(collector.numbers(10).size(), 10u);
  EXPECT_FALSE(player->stats().ended);
  ASSERT_TRUE(player->execute("resume"));
  end(*player);
  EXPECT_EQ(player->stats().published, 10u);
}

// A pause that came before the start used to be forgotten at the start.
TEST_F(PlayerTest, APauseBeforeTheStartHolds) {
  const auto path = tape_of_reports(5, 0);
  Collector collector = reports();
  auto player = this->player(path);
  ASSERT_TRUE(player->execute("pause"));
  const auto thread = run(*player);
  ASSERT_TRUE(player->execute("step"));
  EXPECT_THAT(collector.numbers(1), ElementsAre(0));
  ASSERT_TRUE(player->execute("step"));
  EXPECT_THAT(collector.numbers(2), ElementsAre(0, 1));
  ASSERT_TRUE(player->execute("start"));
  EXPECT_EQ(collector.numbers(5).size(), 5u);
  end(*player);
}

TEST_F(PlayerTest, SeeksForthAndBack) {
  const auto path = scratch_ / "a.mcap";
  Writing writing(path);
  for (int i = 0; i < 10; ++i) writing.detection(static_cast<std::uint32_t>(i), i, 1000 * i);
  writing.close();
  Collector collector = collect(dds::object_detection);
  auto player = this->player(path, {.paused = true});
  const auto thread = run(*player);
  const auto number = [&](std::size_t i) {
    const auto heard = collector.wait(i + 1);
    v1::ObjectDetection detection;
    EXPECT_TRUE(heard.size() > i && dds::decode(dds::object_detection, heard[i], detection));
    return detection.sequence_number();
  };
  // What stands at 3.5 s are the detections 0 to 3.
  EXPECT_EQ(player->execute("seek 3.5").value(), "at 3.500 s");
  ASSERT_TRUE(player->execute("step"));
  EXPECT_EQ(number(4), 4u);
  EXPECT_EQ(player->execute("seek 0").value(), "at 0.000 s");
  ASSERT_TRUE(player->execute("step"));
  EXPECT_EQ(number(5), 0u);
  EXPECT_EQ(player->execute("seek 99").value(), "at 9.000 s");
  ASSERT_TRUE(player->execute("step"));
  EXPECT_EQ(number(6 + 9), 9u);
  // While it plays: the hour between would never end.
  EXPECT_EQ(player->execute("seek 0").value(), "at 0.000 s");
  ASSERT_TRUE(player->execute("resume"));
  ASSERT_TRUE(player->execute("seek 8.9"));
  end(*player);
}

TEST_F(PlayerTest, TheRateChangesWhileItPlays) {
  const auto path = tape_of_reports(10, 3'600'000);  // an hour between them
  Collector collector = reports();
  auto player = this->player(path);
  const auto thread = run(*player);
  EXPECT_THAT(collector.numbers(1), ElementsAre(0));
  for (const char* wrong : {"rate", "rate 0", "rate -1", "rate nan", "rate 1e9", "rate x"})
    EXPECT_FALSE(player->execute(wrong)) << wrong;
  ASSERT_TRUE(player->execute("rate 1000"));
  // 3.6 s each now; then the rest is sought, not waited for.
  EXPECT_THAT(collector.numbers(2), ElementsAre(0, 1));
  EXPECT_EQ(player->stats().rate, 1000);
  const double position = player->stats().position;
  EXPECT_GE(position, 3600);
  EXPECT_LT(position, 3600 + 1000 * 60);
  player->execute("pause");
  player->execute("burst 8");
  EXPECT_EQ(collector.numbers(10).size(), 10u);
  player->execute("resume");
  end(*player);
}

TEST_F(PlayerTest, UnknownOrdersAreAnsweredWithThoseItKnows) {
  const auto path = tape_of_reports(1, 1);
  auto player = this->player(path, {.paused = true});
  for (const char* order : {"", "sing", "burst", "burst 0", "burst x", "seek", "loop", "loop 1"}) {
    const auto answer = player->execute(order);
    ASSERT_FALSE(answer) << order;
    EXPECT_THAT(answer.error().message(), HasSubstr("burst N"));
  }
}

// Each player is a lab's machine with a part of the recording: started at one time with one origin
// they play in the order of the whole, also when one of the parts begins later.
TEST_F(PlayerTest, SeveralStartedTogetherKeepTogether) {
  const auto a = scratch_ / "a.mcap", b = scratch_ / "b.mcap";
  Writing first(a), second(b);
  for (int i = 0; i < 6; i += 2) first.report(i, 100 * i, "a");
  for (int i = 1; i < 6; i += 2) second.report(i, 100 * i, "b");
  first.close();
  second.close();
  Collector collector = reports();
  const Time origin = from_ns(Writing::at(0));
  auto one = player(a, {.from = origin}), other = player(b, {.from = origin});
  const Time start = system_now() + milliseconds(200);
  const std::jthread of_one([&](const std::stop_token& stop) { one->play(stop, start); });
  const std::jthread of_other([&](const std::stop_token& stop) { other->play(stop, start); });
  auto heard = collector.wait(6);
  ASSERT_EQ(heard.size(), 6u);
  EXPECT_THAT(collector.numbers(6), ElementsAre(0, 1, 2, 3, 4, 5));
  // Not before they were due.
  for (int i = 0; i < 6; ++i) EXPECT_GE(heard[i].received, start + milliseconds(100 * i));
}

}  // namespace
}  // namespace prehend::recorder
