// The way of a hand to where a recording begins, as commands: they begin where the hand says that
// it is, end at the first recorded command (dof to 1e-12, which is rounding; the place through a
// quaternion, so to 1e-9), and know no object on the way.
#include "services/recorder/service/hand_easing.hpp"

#include <gtest/gtest.h>

#include "common/convert/convert.hpp"
#include "services/recorder/service/player_service.hpp"
#include "services/recorder/service/recording_file.hpp"
#include "tests/support/hands.hpp"
#include "tests/unit/recording/scratch.hpp"

namespace prehend::recorder {
namespace {

const Time begin = from_ns(1'700'000'000'000'000'000);
const Time today = begin + std::chrono::hours(24);

/// A recording of what each case is about.
class HandEasingTest : public ::testing::Test {
 protected:
  template <class P>
  void write(const dds::Topic<P>& topic, const typename P::type& message) {
    const Source source{dds::raw_topic(topic), "lab"};
    dds::RawSample sample;
    sample.payload = dds::encode(topic, message);
    sample.instance[15] = 1;
    sample.writer[0] = 7;
    sample.sequence = ++sequence_;
    sample.sent = sample.received = begin;
    sources_.push_back(std::make_unique<Source>(source));
    ASSERT_TRUE(file_.write(*sources_.back(), sample, sample.received));
  }
  v2::HandCommand command(const model::HandModel& hand, double dof, double height) {
    v2::HandCommand made;
    made.hand("hand");
    made.model(hand.name());
    made.dof(std::vector<double>(hand.dofs().size(), dof));
    Pose X_WB = Pose::Identity();
    X_WB.translation().z() = height;
    made.X_WB(convert::to_message(X_WB));
    made.mode(v1::MODE_INTELLIGENT);
    made.weight(1);
    made.object("Talc");
    return made;
  }
  v1::HandState state(const model::HandModel& hand, double dof, double height) {
    v1::HandState made;
    made.hand("hand");
    made.dof(std::vector<double>(hand.dofs().size(), dof));
    Pose X_WB = Pose::Identity();
    X_WB.translation().z() = height;
    made.X_WB(convert::to_message(X_WB));
    return made;
  }
  Expected<Tape> tape(const TopicFilter& topics = {}) {
    EXPECT_TRUE(file_.close());
    return open_tape({folder_ / "a.mcap"}, topics);
  }

  static v2::HandCommand decoded(const dds::RawSample& sample) {
    v2::HandCommand command;
    EXPECT_TRUE(dds::decode(dds::robot_command, sample, command));
    return command;
  }

 private:
  testing::Scratch folder_;
  Heading heading_{{}, "", [](const std::string&) { return std::nullopt; }};
  RecordingFile file_ =
      RecordingFile::create(folder_ / "a.mcap", heading_, recording::mcap::Compression::lz4)
          .value();
  std::vector<std::unique_ptr<Source>> sources_;
  std::uint64_t sequence_ = 0;
};

TEST_F(HandEasingTest, LeadsFromWhereTheHandIsToTheFirstCommand) {
  const model::HandModel& hand = test::hand("barrett");
  write(dds::robot_command, command(hand, 0.5, 0.3));
  write(dds::robot_command, command(hand, 0.9, 0.4));
  auto read = tape();
  ASSERT_TRUE(read) << read.error().message();
  auto easing = HandEasing::create(*read, "hand");
  ASSERT_TRUE(easing) << easing.error().message();
  EXPECT_EQ(easing->stream().topic.name, dds::robot_command.name);
  EXPECT_FALSE(easing->begun());
  EXPECT_FALSE(easing->has_arrived(today));

  v1::HandState other = state(hand, 0.1, 0.2);
  other.dof().pop_back();
  easing->on_state(other, today);
  EXPECT_FALSE(easing->begun()) << "a hand of another kind";
  easing->on_state(state(hand, 0.1, 0.2), today);
  ASSERT_TRUE(easing->begun());
  easing->on_state(state(hand, 0.3, 0.2), today + seconds(1));  // it is on its way

  const v2::HandCommand first = decoded(easing->command(today));
  EXPECT_NEAR(first.dof()[0], 0.1, 1e-12);
  EXPECT_EQ(first.stamp_ns(), to_ns(today));
  EXPECT_EQ(first.mode(), v1::MODE_DIRECT);
  EXPECT_EQ(first.weight(), 0);
  EXPECT_EQ(first.object().to_string(), "");
  EXPECT_FALSE(easing->has_arrived(today));

  const Time later = today + std::chrono::minutes(1);
  ASSERT_TRUE(easing->has_arrived(later));
  const v2::HandCommand last = decoded(easing->command(later));
  for (const double dof : last.dof()) EXPECT_NEAR(dof, 0.5, 1e-12);
  EXPECT_NEAR(convert::from_message(last.X_WB())->translation().z(), 0.3, 1e-9);
}

TEST_F(HandEasingTest, SaysWhatIsMissing) {
  const model::HandModel& hand = test::hand("barrett");
  v2::HandCommand shorter = command(hand, 0.5, 0.3);
  shorter.dof().pop_back();
  write(dds::robot_command, shorter);
  auto read = tape();
  ASSERT_TRUE(read);
  EXPECT_EQ(HandEasing::create(*read, "hand").error().what,
            "the first command does not fit the hand");
  read->seek(begin);
  EXPECT_EQ(HandEasing::create(*read, "another").error().what,
            "the recording holds no robot/command for it");
}

// What was consent then is none now, and a status is of a process that is gone.
TEST_F(HandEasingTest, WhatHeldOnlyThenIsNotPlayed) {
  v1::OperatorConsent consent;
  consent.hand("hand");
  write(dds::operator_consent, consent);
  v1::ServiceStatus status;
  status.name("mapping");
  write(dds::service_status, status);
  write(dds::robot_command, command(test::hand("barrett"), 0.5, 0.3));
  const auto read = tape();
  ASSERT_TRUE(read);
  ASSERT_EQ(read->streams().size(), 1u);
  EXPECT_EQ(read->streams().front()->topic.name, dds::robot_command.name);
}

TEST_F(HandEasingTest, ARecordingOfNothingThatIsPlayedIsRefused) {
  v1::OperatorConsent consent;
  consent.hand("hand");
  write(dds::operator_consent, consent);
  EXPECT_FALSE(tape());
}

}  // namespace
}  // namespace prehend::recorder
