// Attacks on a lab of real processes that were found by trying: replies, orders and ids that are
// forged or late, rigs that are patterns, and a hand that an arm carries.
#include <atomic>
#include <fstream>
#include <thread>

#include "tests/integration/safety_rig.hpp"

namespace prehend::integration {
namespace {

using Eigen::Vector3d;

class Attacks : public SafetyRig {
 protected:
  Answer order(Strings words) { return run("prehend", with_lab(std::move(words)), 30); }

  v1::OperatorCommand made(const std::string& id, v1::OperatorAction action,
                           std::int64_t age_ms = 0) {
    v1::OperatorCommand order;
    order.id(id.c_str());
    order.stamp_ns(now_ns() - age_ms * 1'000'000);
    order.action(action);
    order.target("gate");
    order.argument("a test");
    return order;
  }
  /// The reply to an order, which is repeated until it comes.
  std::optional<v1::OperatorReply> give(const v1::OperatorCommand& order) {
    return give(order, orders_);
  }
  std::optional<v1::OperatorReply> give(const v1::OperatorCommand& order,
                                        dds::Writer<v1::OperatorCommand>& orders) {
    std::optional<v1::OperatorReply> reply;
    eventually(20, [&] {
      orders.write(order);
      reply = hear<v1::OperatorReply>(replies_, 0.2, [&](const v1::OperatorReply& one) {
        return one.id().to_string() == order.id().to_string();
      });
      return reply.has_value();
    });
    return reply;
  }

  dds::Writer<v1::OperatorCommand> orders_ = writer(dds::operator_command);
  dds::Reader<v1::OperatorReply> replies_ = reader(dds::operator_reply);
};

// Any service may reply; that a robot has stopped only its gate may say.
TEST_F(Attacks, AReplyOfSomebodyElseIsNoStop) {
  auto heard = reader(dds::operator_command);
  auto answers = writer(dds::operator_reply);
  std::atomic<int> forged = 0;
  std::jthread forger([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      for (auto& sample : heard.take())
        if (!sample.info.gone)
          for (const char* service : {"mapping", "gate"}) {
            v1::OperatorReply reply;
            reply.id(sample.data.id());
            reply.stamp_ns(now_ns());
            reply.service(service);
            reply.done(true);
            reply.message("stopped; the hand holds");
            answers.write(reply);
            ++forged;
          }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  });
  const Answer alone = order({"stop", "--timeout", "2"});
  EXPECT_GT(forged, 0);
  EXPECT_EQ(alone.exit_code, 1) << alone.output;
  EXPECT_NE(alone.output.find("no gate answers"), std::string::npos) << alone.output;
  // Nor does it hide the gate that is there.
  start_hand();
  const Answer both = order({"stop"});
  EXPECT_EQ(both.exit_code, 0) << both.output << both.log;
  EXPECT_NE(both.output.find(name_ + "/hand: stopped"), std::string::npos) << both.output;
  EXPECT_TRUE(wait(20, [&] { return gate_.stopped(); }));
}

// Whoever gave it knew nothing of the stop.
TEST_F(Attacks, AReleaseThatWasGivenBeforeTheStopDoesNotEndIt) {
  start_hand();
  ASSERT_TRUE(give(made("stop", v1::ACTION_STOP)));
  const auto late = give(made("late", v1::ACTION_RELEASE, 2000));
  ASSERT_TRUE(late);
  EXPECT_FALSE(late->done()) << late->message().to_string();
  EXPECT_NE(late->message().to_string().find("before the stop"), std::string::npos);
  EXPECT_TRUE(wait(20, [&] { return gate_.stopped(); }));
  const auto now = give(made("now", v1::ACTION_RELEASE));
  ASSERT_TRUE(now);
  EXPECT_TRUE(now->done()) << now->message().to_string();
  EXPECT_TRUE(wait(20, [&] { return !gate_.stopped(); }));
}

// Guards against who is known by no name yet: a replayer plays what was recorded as soon as it has
// come, before its status or beacon is heard, and so does who never tells of itself.
TEST_F(Attacks, WhatIsPlayedOrSaidByNobodyKnownReleasesNothingAndIsNoConsent) {
  simulation_.emplace(start("simulation", {"safety.deadman=true"}));
  ASSERT_TRUE(wait(30, [&] { return heard_ > 0 && gate_.deadman(); }));
  ASSERT_TRUE(give(made("stop", v1::ACTION_STOP)));
  ASSERT_TRUE(wait(20, [&] { return gate_.stopped(); }));
  const auto consent = [&](bool held) {
    v1::OperatorConsent message;
    message.hand("hand");
    message.stamp_ns(now_ns());
    message.held(held);
    return message;
  };
  for (const char* role : {"replayer", "nobody", "glove"}) {
    auto other = dds::Participant::create(
        {.name = "other", .domain = domain_, .rig = name_, .network = network_, .role = role});
    ASSERT_TRUE(other);
    auto orders = other->writer(dds::operator_command);
    auto consents = other->writer(dds::operator_consent);
    ASSERT_TRUE(orders && consents);
    meet(*orders);
    meet(*consents);
    const std::uint64_t before = dropped("consent of nobody who may give it");
    EXPECT_TRUE(wait(20, [&] {
      consents->write(consent(true));
      EXPECT_FALSE(gate_.consent()) << role;
      return dropped("consent of nobody who may give it") > before;
    })) << role;
    const auto reply = give(made(std::string("of a ") + role, v1::ACTION_RELEASE), *orders);
    ASSERT_TRUE(reply) << role;
    EXPECT_FALSE(reply->done()) << role;
    EXPECT_NE(reply->message().to_string().find("is not obeyed"), std::string::npos)
        << reply->message().to_string();
  }
  listen();
  EXPECT_TRUE(gate_.stopped());
  // Who is known needs no name either.
  auto consents = writer(dds::operator_consent);
  meet(consents);
  EXPECT_TRUE(wait(20, [&] {
    consents.write(consent(true));
    return gate_.consent();
  }));
  const auto released = give(made("of an operator", v1::ACTION_RELEASE));
  ASSERT_TRUE(released);
  EXPECT_TRUE(released->done()) << released->message().to_string();
}

// An order is known by its id, so that it may be repeated; a stop must not be taken for another
// one.
TEST_F(Attacks, AnIdThatWasUsedDoesNotSwallowAStop) {
  start_hand();
  const auto used = give(made("the id", v1::ACTION_RELEASE));
  ASSERT_TRUE(used);
  EXPECT_TRUE(used->done());
  ASSERT_TRUE(give(made("the id", v1::ACTION_STOP)));
  EXPECT_TRUE(wait(20, [&] { return gate_.stopped(); }));
  ASSERT_TRUE(give(made("another", v1::ACTION_RELEASE)));
  ASSERT_TRUE(wait(20, [&] { return !gate_.stopped(); }));
  // Nor the stop of somebody else.
  auto other = dds::Participant::create(
      {.name = "other", .domain = domain_, .rig = name_, .network = network_});
  ASSERT_TRUE(other);
  auto orders = other->writer(dds::operator_command);
  ASSERT_TRUE(orders);
  meet(*orders);
  orders->write(made("the id", v1::ACTION_STOP));
  EXPECT_TRUE(wait(20, [&] { return gate_.stopped(); }));
}

// Each has an id of its own; together they must not push out of the log what has happened.
TEST_F(Attacks, RefusedOrdersDoNotFillTheAuditLog) {
  start_hand({"safety.audit=" + (folder_ / "audit").string()});
  const std::int64_t begin = now_ns();
  for (int i = 0; i < 50; ++i) {
    v1::OperatorCommand without_reason = made("id " + std::to_string(i), v1::ACTION_RELEASE);
    without_reason.argument("");
    const auto reply = give(without_reason);
    ASSERT_TRUE(reply);
    ASSERT_FALSE(reply->done());
  }
  std::ifstream log(folder_ / "audit" / "hand.jsonl");
  int lines = 0;
  for (std::string line; std::getline(log, line);)
    lines += line.find("order_refused") != std::string::npos;
  EXPECT_GE(lines, 1);
  const auto periods = static_cast<int>((now_ns() - begin) / 10'000'000'000);
  EXPECT_LE(lines, 2 + periods) << "the first, and every 10 s how many there were";
}

// «*» is every rig to DDS: one mapping would lead the robots of all.
TEST_F(Attacks, WhoMovesSomethingTakesPartInOneRig) {
  for (const char* program : {"prehend-mapping", "prehend-glove", "prehend-simulation"})
    for (const char* rig : {"*", "te?t", "[a-z]*"}) {
      const Answer refused = run(program, lab_arguments({std::string("lab.rig=") + rig}), 20);
      EXPECT_EQ(refused.exit_code, 2) << program << " " << rig << refused.log;
      EXPECT_NE(refused.log.find("more than one rig"), std::string::npos) << refused.log;
    }
}

// Of a hand that an arm carries it is known where it is, before anybody has led it.
TEST_F(Attacks, TheFirstCommandToAHandOnAnArmKeepsTheLimits) {
  simulation_.emplace(start(
      "simulation", {"robot.arm=puma560", "robot.X_WA=[0, -0.7, 0, 0.7071068, 0, 0, 0.7071068]"}));
  meet(commands_);
  ASSERT_TRUE(wait(30, [&] { return heard_ > 5; }));
  EXPECT_FALSE(gate_.placed()) << "nobody has led it yet";
  const Vector3d away = base() + Vector3d(0, 0, 1);
  // One that comes late is refused, and the next is the first.
  EXPECT_TRUE(send(
      commands_, 20, [&] { return command(away); },
      [&] { return dropped("command cut: base speed") > 0; }))
      << "it was let go anywhere";
}

}  // namespace
}  // namespace prehend::integration
