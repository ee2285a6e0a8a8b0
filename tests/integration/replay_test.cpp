// Replaying with real processes: keys on a terminal, several players started together, another rig
// and domain, a robot hand that is first moved to where the recording begins. What a player does
// with each order, tests/unit/recorder asks more closely.
//
// Recordings that keys and orders work on have their messages an hour apart, so that nothing comes
// by itself.
#include <cstdlib>
#include <mutex>
#include <nlohmann/json.hpp>

#include "common/base/paths.hpp"
#include "common/convert/convert.hpp"
#include "common/dds/raw.hpp"
#include "common/model/hand_model.hpp"
#include "services/recorder/service/recording_file.hpp"
#include "tests/integration/rig.hpp"
#include "tests/integration/terminal.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::integration {
namespace {

using std::chrono::milliseconds;

constexpr std::int64_t begin_ns = 1'700'000'000'000'000'000;

class Replay : public Rig {
 protected:
  std::string file(const std::string& name) { return (folder_ / name).string(); }

  template <class P>
  void write(recorder::RecordingFile& file, const recorder::Source& source,
             const dds::Topic<P>& topic, const typename P::type& message, Duration time) {
    dds::RawSample sample;
    sample.payload = dds::encode(topic, message);
    sample.instance[15] = 1;
    sample.writer[0] = 7;
    sample.sequence = ++sequence_;
    sample.sent = sample.received = from_ns(begin_ns) + time;
    ASSERT_TRUE(file.write(source, sample, sample.received));
  }
  recorder::RecordingFile create(const std::string& name) {
    return recorder::RecordingFile::create(file(name), heading_, recording::mcap::Compression::lz4)
        .value();
  }
  /// Reports with these numbers; their topic keeps all, so a late reader misses none.
  std::string reports(const std::string& name, const std::vector<int>& numbers, Duration step) {
    auto recording = create(name);
    const recorder::Source source{dds::raw_topic(dds::grasp_report), name_};
    for (const int number : numbers) {
      v1::GraspReport report;
      report.hand("hand");
      report.sequence_number(static_cast<std::uint64_t>(number));
      write(recording, source, dds::grasp_report, report, number * step);
    }
    EXPECT_TRUE(recording.close());
    return file(name);
  }
  /// Numbers of reports, as they come.
  static void take(dds::Reader<v1::GraspReport>& reader, std::vector<std::uint64_t>& numbers) {
    for (const auto& sample : reader.take())
      if (!sample.info.gone) numbers.push_back(sample.data.sequence_number());
  }
  static testing::AssertionResult heard(dds::Reader<v1::GraspReport>& reader,
                                        std::vector<std::uint64_t>& numbers, std::size_t count) {
    const bool all = eventually(20, [&] {
      take(reader, numbers);
      return numbers.size() >= count;
    });
    if (all && numbers.size() == count) return testing::AssertionSuccess();
    return testing::AssertionFailure() << numbers.size() << " reports instead of " << count;
  }

  recorder::Heading heading_{{}, "", [](const std::string&) { return std::nullopt; }};
  std::uint64_t sequence_ = 0;
};

TEST_F(Replay, KeysPauseStepSeekAndStop) {
  std::vector<int> numbers(40);
  for (int i = 0; i < 40; ++i) numbers[static_cast<std::size_t>(i)] = i;
  const std::string tape = reports("tape.mcap", numbers, std::chrono::hours(1));
  auto reader = this->reader(dds::grasp_report);
  std::vector<std::uint64_t> came;
  Terminal player(program("prehend-replay"), with_lab({tape, "--delay", "0"}));
  ASSERT_TRUE(heard(reader, came, 1));  // it plays
  EXPECT_FALSE(player.is_a_shells());
  player.press(" ");
  EXPECT_TRUE(player.shows("paused"));
  player.press("s");
  EXPECT_TRUE(player.shows("stepped"));
  EXPECT_TRUE(heard(reader, came, 2));
  player.press("b");
  EXPECT_TRUE(player.shows("burst of 10"));
  EXPECT_TRUE(heard(reader, came, 12));
  for (std::size_t i = 0; i < came.size(); ++i) EXPECT_EQ(came[i], i);
  player.press("\x1b[C");  // right
  EXPECT_TRUE(player.shows("at 39605.000 s"));
  player.press("\x1b[D");
  EXPECT_TRUE(player.shows("at 39600.000 s"));
  player.press("\x1b[A");
  EXPECT_TRUE(player.shows("rate 1.25"));
  player.press("\x1b[B");
  EXPECT_TRUE(player.shows("rate 1"));
  player.press("l");
  EXPECT_TRUE(player.shows("loop on"));
  player.press("l");
  EXPECT_TRUE(player.shows("loop off"));
  player.press(" ");
  EXPECT_TRUE(player.shows("playing"));
  player.press("x");  // means nothing
  player.press("q");
  EXPECT_TRUE(player.shows("stopped"));
  EXPECT_EQ(player.end(), 0);
  EXPECT_TRUE(player.is_a_shells()) << "the terminal is not as it was";
}

TEST_F(Replay, SeveralPlayersStartedTogetherKeepTogether) {
  const std::string even = reports("even.mcap", {0, 2, 4}, milliseconds(100));
  const std::string odd = reports("odd.mcap", {1, 3, 5}, milliseconds(100));
  auto reader = this->reader(dds::grasp_report);
  // The next whole second but one, in both ways to say it.
  const std::int64_t start_s = now_ns() / 1'000'000'000 + 2;
  char text[32];
  const std::time_t start = start_s;
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&start));
  const Strings common{"--quiet", "--origin", std::to_string(begin_ns / 1'000'000'000)};
  Strings one = with_lab({even, "--start-at", text});
  Strings other = with_lab({odd, "--start-at", std::to_string(start_s)});
  for (Strings* arguments : {&one, &other})
    arguments->insert(arguments->end(), common.begin(), common.end());
  auto first = start_program("prehend-replay", one),
       second = start_program("prehend-replay", other);
  std::vector<std::uint64_t> came;
  EXPECT_TRUE(heard(reader, came, 6));
  EXPECT_EQ(came, (std::vector<std::uint64_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_GE(now_ns(), start_s * 1'000'000'000 + 500'000'000);
  for (auto* process : {&first, &second}) {
    const auto exit = process->wait(seconds(10));
    EXPECT_TRUE(exit && exit->code == 0);
  }
}

TEST_F(Replay, PlaysToAnotherRigAndDomainAndTellsInJson) {
  const std::string tape = reports("tape.mcap", {0, 1, 2, 3}, milliseconds(10));
  const test::DomainLease other;
  const int domain = other.domain();
  auto elsewhere =
      dds::Participant::create({.name = "there", .domain = domain, .rig = name_ + "-there"});
  ASSERT_TRUE(elsewhere);
  auto there = elsewhere->reader(dds::grasp_report);
  ASSERT_TRUE(there);
  const Answer answer = run("prehend",
                            with_lab({"replay", tape, "--json", "--rig", name_ + "-there",
                                      "--domain", std::to_string(domain), "--from", "0.01"}),
                            30);
  ASSERT_EQ(answer.exit_code, 0) << answer.log;
  const auto document = nlohmann::json::parse(answer.output);
  // What stands at the beginning is played too: this topic keeps all.
  EXPECT_EQ(document["published"], 4);
  EXPECT_EQ(document["refused"], 0);
  EXPECT_EQ(document["damage"], 0);
  EXPECT_GE(document["late_us"]["p99"], document["late_us"]["p50"]);
  std::vector<std::uint64_t> came;
  EXPECT_TRUE(heard(*there, came, 4));
}

// An order that was given then is played, from a recording of when orders had a key, but the player
// does not obey it; and what processes said of themselves then is not so now.
TEST_F(Replay, OldOrdersAreHeardButNotObeyedAndOldStatusesAreNot) {
  const std::string tape = file("old.mcap");
  {
    auto recording = create("old.mcap");
    const auto source = [&](std::string_view topic, const char* type) {
      return recorder::Source{{std::string(topic), type, true, dds::find_topic(topic)->qos}, name_};
    };
    v1::OperatorCommand order;
    order.id("then");
    order.action(v1::ACTION_STOP);
    v1::ServiceStatus status;
    status.service("ghost@then/1");
    v1::GraspReport report;
    report.hand("hand");
    const auto statuses = source("service/status", "prehend::v1::ServiceStatus"),
               orders = source("operator/command", "prehend::v1::OperatorCommand"),
               reports = source("grasp/report", "prehend::v1::GraspReport");
    for (int i = 0; i < 4; ++i) {
      const Duration time = i * milliseconds(100);
      report.sequence_number(static_cast<std::uint64_t>(i));
      write(recording, statuses, dds::service_status, status, time);
      write(recording, orders, dds::operator_command, order, time);
      write(recording, reports, dds::grasp_report, report, time);
    }
    ASSERT_TRUE(recording.close());
  }
  auto orders = reader(dds::operator_command);
  auto statuses = reader(dds::service_status);
  auto reports = reader(dds::grasp_report);
  auto player = start_program("prehend-replay", with_lab({tape, "--quiet", "--loop"}));
  std::size_t given = 0, judged = 0, ours = 0;
  EXPECT_TRUE(eventually(20,
                         [&] {
                           given += orders.take().size();
                           judged += reports.take().size();
                           for (const auto& sample : statuses.take()) {
                             EXPECT_NE(sample.data.service().to_string(), "ghost@then/1");
                             ours += sample.data.service().to_string().starts_with("replayer");
                           }
                           return given > 4 && judged > 4 && ours > 1;
                         }))
      << given << " orders, " << judged << " reports, " << ours << " statuses";
  EXPECT_FALSE(player.exit()) << "it obeyed an order that it played";
}

TEST_F(Replay, WrongUseIsOneLine) {
  const std::string tape = reports("tape.mcap", {0, 1}, milliseconds(10));
  for (const Strings& arguments :
       {Strings{"--remap", "a"}, Strings{"--remap", "=b"}, Strings{"--qos", "hand/*"},
        Strings{"--qos", "hand/*=fast"}, Strings{"--start-at", "noon"}, Strings{"--rate", "0"},
        Strings{"--stamps", "later"}, Strings{"--from", "9"}, Strings{"--from", "-1"}}) {
    Strings all{"replay", tape, "--delay", "0"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Answer answer = run("prehend", with_lab(all), 20);
    EXPECT_EQ(answer.exit_code, 2) << arguments[0] << " " << arguments[1] << answer.log;
    EXPECT_EQ(std::count(answer.log.begin(), answer.log.end(), '\n'), 1) << answer.log;
  }
}

// The hand of the simulation stands still somewhere; the recording begins elsewhere. Between them
// no command may ask for more than half of a DoF's greatest speed, which is what EaseIn promises;
// stamps are those at which the commands were made, so the quotients are exact up to rounding.
TEST_F(Replay, EasesTheHandToWhereTheRecordingBegins) {
  const auto model = model::HandModel::load(share_directory() / "models/hands" / "barrett").value();
  v2::HandCommand goal;
  goal.hand("hand");
  goal.model("barrett");
  goal.mode(v1::MODE_INTELLIGENT);
  goal.weight(0.7);
  goal.object("Cup");
  goal.origin_ns(1);
  std::vector<double> dof;
  for (std::size_t i = 0; i < model.dofs().size(); ++i) dof.push_back(0.3 + 0.1 * i);
  goal.dof(dof);
  Pose X_WB = Pose::Identity();
  X_WB.translation() = Eigen::Vector3d(0.1, 0.2, 0.6);
  goal.X_WB(convert::to_message(X_WB));
  {
    auto recording = create("goal.mcap");
    const recorder::Source source{dds::raw_topic(dds::robot_command), name_};
    for (int i = 0; i < 3; ++i)
      write(recording, source, dds::robot_command, goal, milliseconds(20 * i));
    ASSERT_TRUE(recording.close());
  }
  auto states = reader(dds::robot_state);
  auto commands = reader(dds::robot_command);
  auto simulation = start("simulation", {"simulation.hand=barrett"});
  const auto begin = hear<v1::HandState>(states, 30, [](const v1::HandState&) { return true; });
  ASSERT_TRUE(begin);
  auto player =
      start_program("prehend-replay", with_lab({file("goal.mcap"), "--quiet", "--ease-in", "hand",
                                                "--stamps", "now", "-t", "robot/command"}));
  std::vector<v2::HandCommand> eased;
  std::optional<v2::HandCommand> recorded;
  ASSERT_TRUE(eventually(30, [&] {
    for (const auto& sample : commands.take()) {
      if (sample.info.gone) continue;
      if (sample.data.origin_ns() == 0)  // no glove is behind it
        eased.push_back(sample.data);
      else if (!recorded)
        recorded = sample.data;
    }
    return recorded.has_value();
  }));
  ASSERT_GT(eased.size(), 20u);
  EXPECT_EQ(recorded->dof(), goal.dof());
  EXPECT_EQ(recorded->mode(), v1::MODE_INTELLIGENT);
  for (const v2::HandCommand& command : eased) {
    EXPECT_EQ(command.mode(), v1::MODE_DIRECT);  // it moves
    EXPECT_EQ(command.weight(), 0);
    EXPECT_EQ(command.object(), "");
  }
  for (std::size_t i = 0; i < dof.size(); ++i) {
    const double limit = 0.5 * model.dofs()[i].max_velocity;
    // The first command is made one tick of 10 ms or so after the state.
    EXPECT_NEAR(eased.front().dof()[i], begin->dof()[i], 0.1 * limit);
    // The reader keeps the newest command only: the very last one of the way may be passed by.
    EXPECT_NEAR(eased.back().dof()[i], dof[i], 1e-3);
    for (std::size_t k = 1; k < eased.size(); ++k) {
      const double dt = 1e-9 * static_cast<double>(eased[k].stamp_ns() - eased[k - 1].stamp_ns());
      ASSERT_GT(dt, 0);
      EXPECT_LE(std::abs(eased[k].dof()[i] - eased[k - 1].dof()[i]) / dt, limit * (1 + 1e-9));
    }
  }
  const auto& from = begin->X_WB().position();
  EXPECT_GT(std::hypot(from.x() - 0.1, from.y() - 0.2, from.z() - 0.6), 0.05);
  EXPECT_NEAR(eased.back().X_WB().position().z(), 0.6, 1e-3);
  // The hand came along.
  EXPECT_TRUE(hear<v1::HandState>(states, 10, [&](const v1::HandState& state) {
    double error = std::abs(state.X_WB().position().z() - 0.6);
    for (std::size_t i = 0; i < dof.size(); ++i)
      error = std::max(error, std::abs(state.dof()[i] - dof[i]));
    return error < 0.05;
  }));
  const auto exit = player.wait(seconds(10));
  EXPECT_TRUE(exit && exit->code == 0);
}

// A recording comes from anywhere: what it calls its hand is a name, never the way to a file.
TEST_F(Replay, ARecordedHandIsANameAndNoPath) {
  for (const std::string model : {"../hands/barrett", "/tmp", "."}) {
    v2::HandCommand command;
    command.hand("hand");
    command.model(model);
    auto recording = create("path.mcap");
    write(recording, {dds::raw_topic(dds::robot_command), name_}, dds::robot_command, command,
          milliseconds(0));
    ASSERT_TRUE(recording.close());
    const Answer answer =
        run("prehend", with_lab({"replay", file("path.mcap"), "--ease-in", "hand"}), 20);
    EXPECT_EQ(answer.exit_code, 3) << answer.log;
    EXPECT_NE(answer.log.find("no hand of this name"), std::string::npos) << answer.log;
    std::filesystem::remove(file("path.mcap"));
  }
}

TEST_F(Replay, WithoutAHandThereIsNoEasing) {
  const std::string sample = test::in_sources("deploy/samples/direct-grasp.mcap");
  const Answer unknown = run("prehend", with_lab({"replay", sample, "--ease-in", "claw"}), 20);
  EXPECT_EQ(unknown.exit_code, 3) << unknown.log;
  EXPECT_NE(unknown.log.find("--ease-in claw"), std::string::npos) << unknown.log;
}

}  // namespace
}  // namespace prehend::integration
