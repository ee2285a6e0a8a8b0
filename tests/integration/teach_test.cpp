// From showing to using, with real processes: a person (who publishes hand/posture) is taught from
// by prehend-teach, prehend-train makes a model of it, prehend-mapping answers with that model; and
// the recording of the session gives the same set again. How long a person needs is measured.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <set>

#include "common/dds/topics.hpp"
#include "common/learning/training_set.hpp"
#include "tests/integration/rig.hpp"
#include "tests/integration/shown_hand.hpp"

namespace prehend::integration {
namespace {

class Teach : public Rig {
 protected:
  void publish(const Closure& closure) {
    ASSERT_TRUE(writer_.write(shown_hand(closure, ++frames_)));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the glove's rate
  }

  /// A closed index finger closes fingers 1 and 2 (here 120 degrees were taught) and not the third.
  void expect_answers_as_taught(const std::string& model) {
    auto commands = reader(dds::robot_command);
    stage::Process mapping =
        start("mapping", {"mapping.model=" + model, "mapping.intelligent=false"});
    std::vector<double> dof;
    EXPECT_TRUE(eventually(20, [&] {
      publish({0, 1, 1, 0, 0});
      for (const auto& sample : commands.take())
        if (!sample.info.gone) dof = sample.data.dof();
      return dof.size() == 4 && dof[1] > 1.6 && dof[2] > 1.6 && dof[3] < 0.5;
    })) << testing::PrintToString(dof);
  }

  const std::vector<std::pair<std::string, Closure>> lessons_{
      {"open", {0, 0, 0, 0, 0}},          {"thumb half", {0.5, 0, 0, 0, 0}},
      {"thumb closed", {1, 0, 0, 0, 0}},  {"index half", {0, 0.5, 0.5, 0, 0}},
      {"index closed", {0, 1, 1, 0, 0}},  {"little half", {0, 0, 0, 0.5, 0.5}},
      {"little closed", {0, 0, 0, 1, 1}},
  };
  dds::Writer<v1::HandPosture> writer_ = writer(dds::hand_posture);
  std::uint64_t frames_ = 0;
};

TEST_F(Teach, ShownTrainedUsedAndRepeatedFromTheRecording) {
  const std::string set = (folder_ / "taught.set").string(),
                    again = (folder_ / "again.set").string(),
                    model = (folder_ / "taught.mapping").string(),
                    recording = (folder_ / "session.mcap").string();
  auto orders = reader(dds::operator_command);
  stage::Process recorder = start_program(
      "prehend-record", with_lab({"hand/posture", "operator/command", "--quiet", "-o", recording}));
  stage::Process teacher =
      start_program("prehend-teach", with_lab({"--user", "tester", "-o", set, "--limit", "60"}));

  std::optional<std::int64_t> first;
  for (const auto& [name, closure] : lessons_) {
    const bool taken = eventually(25, [&, posture = closure, label = name] {
      publish(posture);
      for (const auto& sample : orders.take())
        if (!sample.info.gone && sample.data.argument().to_string() == label) return true;
      return false;
    });
    ASSERT_TRUE(taken) << name;
    if (!first) first = now_ns();
  }
  RecordProperty("seconds_of_showing", std::to_string(1e-9 * double(now_ns() - *first)));
  const auto ended = teacher.wait(seconds(10));
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->code, 0);
  recorder.signal(SIGINT);
  ASSERT_TRUE(recorder.wait(seconds(10)));

  const auto taught = learning::load_training_set(set);
  ASSERT_TRUE(taught) << taught.error().message();
  ASSERT_EQ(taught->pairs.size(), lessons_.size());
  EXPECT_EQ(taught->pairs[4].posture, "index closed");
  EXPECT_EQ(taught->pairs[4].user, "tester");
  EXPECT_EQ(taught->pairs[4].source, "teach");

  // The recording says the same, up to the frames at the ends of each window.
  const Answer from =
      run("prehend-teach", {"--user", "tester", "--from", recording, "-o", again}, 30);
  ASSERT_EQ(from.exit_code, 0) << from.log;
  const auto repeated = learning::load_training_set(again);
  ASSERT_TRUE(repeated);
  ASSERT_EQ(repeated->pairs.size(), taught->pairs.size());
  for (std::size_t i = 0; i < lessons_.size(); ++i) {
    EXPECT_EQ(repeated->pairs[i].posture, taught->pairs[i].posture);
    EXPECT_EQ(repeated->pairs[i].source, "recording");
    EXPECT_TRUE(repeated->pairs[i].features.isApprox(taught->pairs[i].features, 1e-6));
  }

  const Answer trained =
      run("prehend-train", {"--set", set, "--users", "4", "--out", model, "--json"}, 60);
  ASSERT_EQ(trained.exit_code, 0) << trained.log;
  RecordProperty("training_seconds",
                 nlohmann::json::parse(trained.output)["training_seconds"].dump());

  expect_answers_as_taught(model);
}

// The same by orders, as from a page: prehend-teacher obeys them and tells how far it is.
// Long: one session, from its first posture to the hand that was taught.
TEST_F(Teach, ByOrdersToTheTeacher) {
  auto orders = writer(dds::operator_command);
  auto replies = reader(dds::operator_reply);
  auto told = reader(dds::mapping_training);
  const auto start_teacher = [&](const std::string& users) {
    return start("teacher", {"teacher.folder=" + (folder_ / "taught").string(), users});
  };
  stage::Process teacher = start_teacher("teacher.users=2");
  int given = 0;
  const auto answer = [&](const std::string& words) {
    v1::OperatorCommand order;
    order.id("test-" + std::to_string(++given));
    order.action(v1::ACTION_TEACH);
    order.target("teacher");
    order.argument(words);
    std::optional<v1::OperatorReply> reply;
    // Given again until the teacher is there: by its id it is known as the same order.
    eventually(30, [&] {
      order.stamp_ns(now_ns());
      orders.write(order);
      reply = hear<v1::OperatorReply>(replies, 1, [&](const auto& one) {
        return one.id().to_string() == order.id().to_string();
      });
      return reply.has_value();
    });
    return reply.value_or(v1::OperatorReply());
  };
  const auto until = [&](double limit_s,
                         const std::function<bool(const v1::TrainingProgress&)>& so) {
    return hear<v1::TrainingProgress>(told, limit_s, so);
  };
  EXPECT_FALSE(answer("show ../escape").done());
  EXPECT_FALSE(answer("dance").done());
  const auto early = answer("train tester");
  EXPECT_FALSE(early.done());
  EXPECT_THAT(early.message().to_string(), testing::HasSubstr("nothing was shown"));
  EXPECT_FALSE(answer("again").done());

  const auto begun = answer("show tester");
  ASSERT_TRUE(begun.done()) << begun.message().to_string();
  EXPECT_EQ(begun.message().to_string(), "show «open»");
  EXPECT_THAT(answer("again").message().to_string(), testing::HasSubstr("nothing was shown yet"));
  EXPECT_THAT(answer("train tester").message().to_string(),
              testing::HasSubstr("postures are being shown (end it first)"));
  std::size_t shown = 0;
  std::string file;
  for (const auto& [name, closure] : lessons_) {
    ++shown;
    ASSERT_TRUE(eventually(25, [&, posture = closure] {
      publish(posture);
      for (const auto& sample : told.take()) {
        const v1::TrainingProgress& progress = sample.data;
        if (sample.info.gone) continue;
        if (progress.phase() == v1::TRAINING_DONE) file = progress.message().to_string();
        if (progress.shown() >= shown) return true;
      }
      return false;
    })) << name;
  }
  if (file.empty()) {
    const auto done = until(20, [](const auto& one) { return one.phase() == v1::TRAINING_DONE; });
    ASSERT_TRUE(done);
    file = done->message().to_string();
  }
  const auto taught = learning::load_training_set(file);
  ASSERT_TRUE(taught) << taught.error().message();
  ASSERT_EQ(taught->pairs.size(), lessons_.size());
  EXPECT_EQ(taught->pairs[4].posture, "index closed");
  EXPECT_EQ(taught->pairs[4].user, "tester");

  const auto trains = answer("train tester");
  ASSERT_TRUE(trains.done()) << trains.message().to_string();
  double share = 0;
  const auto trained = until(120, [&](const v1::TrainingProgress& one) {
    EXPECT_NE(one.phase(), v1::TRAINING_FAILED) << one.message().to_string();
    if (one.phase() == v1::TRAINING_COMPUTING) share = std::max(share, one.share());
    return one.phase() == v1::TRAINING_DONE && one.share() == 1 &&
           one.message().to_string() != file;
  });
  ASSERT_TRUE(trained) << "it came to " << share;
  expect_answers_as_taught(trained->message().to_string());

  // One that learns from many people does so for minutes, and ends in the middle of it.
  teacher.stop(seconds(10));
  stage::Process busy = start_teacher("teacher.users=300");
  ASSERT_TRUE(answer("train tester").done());
  ASSERT_TRUE(until(90, [](const auto& one) {
    return one.phase() == v1::TRAINING_COMPUTING && one.share() > 0 && one.share() < 0.5;
  }));
  EXPECT_THAT(answer("again").message().to_string(),
              testing::HasSubstr("trains, and takes no order until that is done"));
  const std::int64_t asked = now_ns();
  busy.signal(SIGTERM);
  const auto end = busy.wait(seconds(15));
  ASSERT_TRUE(end) << "it waits for its training";
  EXPECT_EQ(end->code, 0);
  RecordProperty("seconds_to_end", std::to_string(1e-9 * static_cast<double>(now_ns() - asked)));
}

TEST_F(Teach, WhatCannotBeIsOneLine) {
  const Answer silent = run("prehend-teach", with_lab({"-o", "x.set", "--limit", "1"}), 30);
  EXPECT_EQ(silent.exit_code, 1);
  EXPECT_THAT(silent.log, testing::HasSubstr("gave up after 1 s, at «open»"));
  const Answer missing = run("prehend-teach", {"-o", "x.set", "--from", "nowhere.mcap"}, 30);
  EXPECT_EQ(missing.exit_code, 3);
  EXPECT_THAT(missing.log, testing::HasSubstr("nowhere.mcap"));
  const Answer label = run("prehend-teach", {"-o", "x", "--from", "y", "--label", "open"}, 30);
  EXPECT_EQ(label.exit_code, 2);
  EXPECT_EQ(run("prehend-teach", {}, 30).exit_code, 2);
  for (const auto& [set, words] :
       {std::pair("mapping.hand=", "mapping.hand: names no hand"),
        std::pair("teacher.users=1001", "teacher.users: is none of 0 to 1000"),
        std::pair("lab.lockstep=true", "lab.lockstep: nobody is taught in lockstep")}) {
    const Answer teacher = run("prehend-teacher", lab_arguments({set}), 20);
    EXPECT_EQ(teacher.exit_code, 2) << set;
    EXPECT_THAT(teacher.log, testing::HasSubstr(words));
  }
  EXPECT_EQ(run("prehend-teach", {"-o", "x", "--hand", "foot"}, 30).exit_code, 3);
}

}  // namespace
}  // namespace prehend::integration
