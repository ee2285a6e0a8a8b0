// The mode of a live mapping is changed by operator/command: the real process answers each order on
// operator/reply, refuses what it does not understand and goes on as before, and no joint of the
// hand goes faster than it may through any change.
#include <gmock/gmock.h>

#include <cmath>

#include "common/dds/topics.hpp"
#include "tests/integration/rig.hpp"
#include "tests/integration/shown_hand.hpp"
#include "tests/support/hands.hpp"

namespace prehend::integration {
namespace {

class SetMode : public Rig {
 protected:
  /// The same slightly bent hand, at the glove's rate. No finger of it meets another.
  void publish() {
    ASSERT_TRUE(postures_.write(shown_hand({0.1, 0.3, 0.3, 0.1, 0.1}, ++frames_)));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }

  /// Takes what the mapping commands, and looks at each step.
  void watch() {
    for (const auto& sample : commands_.take()) {
      if (sample.info.gone) continue;
      const v2::HandCommand& now = sample.data;
      if (last_) {
        const double t = 1e-9 * static_cast<double>(now.stamp_ns() - last_->stamp_ns());
        for (std::size_t i = 0; i < now.dof().size(); ++i)
          EXPECT_LE(std::abs(now.dof()[i] - last_->dof()[i]),
                    test::hand("barrett").dofs()[i].max_velocity * std::max(0.0, t) + 1e-9);
      }
      // A mapping that holds has not seen the hand for a while.
      moved_ = !last_ || now.dof() != last_->dof() || now.mode() == v1::MODE_HOLD;
      last_ = now;
    }
  }

  /// Shows the hand until the mapping has answered the order.
  v1::OperatorReply order(const std::string& argument, const std::string& target = "mapping") {
    v1::OperatorCommand command;
    command.id("order-" + std::to_string(++order_count_));
    command.stamp_ns(now_ns());
    command.action(v1::ACTION_SET_MODE);
    command.target(target);
    command.argument(argument);
    EXPECT_TRUE(orders_.write(command));
    std::optional<v1::OperatorReply> reply;
    EXPECT_TRUE(eventually(15, [&] {
      publish();
      watch();
      for (const auto& sample : replies_.take())
        if (!sample.info.gone && sample.data.id() == command.id()) reply = sample.data;
      return reply.has_value();
    })) << argument;
    return reply.value_or(v1::OperatorReply());
  }

  /// Shows the hand until the fingers have come to rest: where they are then.
  std::vector<double> at_rest() {
    int still = 0;
    EXPECT_TRUE(eventually(20, [&] {
      publish();
      moved_ = true;
      watch();
      still = moved_ ? 0 : still + 1;
      return still > 10;
    }));
    return last_ ? last_->dof() : std::vector<double>();
  }

  dds::Reader<v2::HandCommand> commands_ = reader(dds::robot_command);
  dds::Reader<v1::OperatorReply> replies_ = reader(dds::operator_reply);
  dds::Writer<v1::HandPosture> postures_ = writer(dds::hand_posture);
  dds::Writer<v1::OperatorCommand> orders_ = writer(dds::operator_command);
  std::optional<v2::HandCommand> last_;
  std::uint64_t frames_ = 0;
  int order_count_ = 0;
  bool moved_ = false;
};

double apart(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

TEST_F(SetMode, ChangesTheLiveMappingWithoutAJump) {
  const auto mapping = start("mapping");
  const auto joints = at_rest();
  ASSERT_EQ(joints.size(), 4u);

  const auto accepted = order("cartesian");
  EXPECT_TRUE(accepted.done());
  EXPECT_EQ(accepted.service().to_string(), "mapping");
  EXPECT_EQ(accepted.message().to_string(), "cartesian intelligent placement");
  const auto cartesian = at_rest();
  EXPECT_GT(apart(joints, cartesian), 0.05) << "fingertips and postures answer differently";

  // What is not understood changes nothing.
  for (const auto& [bad, word] : {std::pair<std::string, std::string>{"telepathy", "telepathy"},
                                  {"", "no mode is named"},
                                  {"direct intelligent", "contradicts"},
                                  {std::string(128, 'x'), "there is no mode"}}) {
    const auto refused = order(bad);
    EXPECT_FALSE(refused.done()) << bad;
    EXPECT_THAT(refused.message().to_string(), testing::HasSubstr(word));
  }
  EXPECT_LT(apart(cartesian, at_rest()), 1e-6);

  // No target: for everyone. The other words, and back.
  const auto direct = order("direct no-placement joints", "");
  EXPECT_TRUE(direct.done());
  EXPECT_EQ(direct.message().to_string(), "joints direct no-placement");
  EXPECT_LT(apart(joints, at_rest()), 1e-6);
}

TEST_F(SetMode, OrdersForOthersAreNotAnswered) {
  const auto mapping = start("mapping");
  at_rest();
  v1::OperatorCommand other;
  other.id("other");
  other.stamp_ns(now_ns());
  other.action(v1::ACTION_SET_MODE);
  other.target("simulation");
  other.argument("cartesian");
  ASSERT_TRUE(orders_.write(other));
  // Orders are reliable and in order: what follows is answered alone.
  EXPECT_EQ(order("retargeting").message().to_string(), "retargeting intelligent placement");
  EXPECT_TRUE(replies_.take().empty());
}

TEST_F(SetMode, SettingsThatCannotBeAreSaidByTheirKeys) {
  for (const auto& [sets, words] :
       {std::pair<Strings, std::string>({"mapping.hand="}, "mapping.hand: names no hand"),
        {{"mapping.hand=barrett_left", "tracker.X_WT=[0, 0, 0]"},
         "tracker.X_WT: needs seven numbers: x y z in m, then the quaternion w x y z"},
        {{"mapping.mode=telepathy"}, "mapping.mode: there is no «telepathy»"},
        {{"mapping.clutch_speed=0"},
         "mapping.clutch_speed, _turn_speed, _finger_speed: must be"}}) {
    const Answer answer = run("prehend-mapping", lab_arguments(sets), 20);
    EXPECT_EQ(answer.exit_code, 2) << sets.back();
    EXPECT_THAT(answer.log, testing::HasSubstr(words));
  }
}

}  // namespace
}  // namespace prehend::integration
