// The latched stop, by `prehend stop` and `prehend release`, in a lab of real processes: nothing
// moves the hand until the release, whatever happens to mapping, and then nothing moves it faster
// than it may.
#include <fmt/format.h>

#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "common/base/file_text.hpp"
#include "common/service/status_publisher.hpp"
#include "tests/integration/safety_rig.hpp"
#include "tests/integration/terminal.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::integration {
namespace {

using Eigen::Vector3d;
using json = nlohmann::json;

class Stop : public SafetyRig {
 protected:
  Answer order(Strings words) { return run("prehend", with_lab(std::move(words)), 30); }
  json ordered(Strings words, int exit_code = 0) {
    words.push_back("--json");
    const Answer answer = order(words);
    EXPECT_EQ(answer.exit_code, exit_code) << answer.log << answer.output;
    return json::parse(answer.output, nullptr, false);
  }
  /// The hand stays within a tenth of a millimetre and, its fingers, a thousandth of a radian, from
  /// now on for so many states.
  void expect_still(int states) {
    ASSERT_TRUE(wait(20, [&, first = heard_] { return heard_ > first + 5; }));
    const v1::HandState then = state_;
    double moved = 0, turned = 0;
    ASSERT_TRUE(wait(30, [&, first = heard_] {
      moved = std::max(moved, (base() - convert::from_message(then.X_WB().position())).norm());
      for (std::size_t i = 0; i < then.dof().size(); ++i)
        turned = std::max(turned, std::abs(state_.dof()[i] - then.dof()[i]));
      return heard_ > first + states;
    })) << "robot/state is silent";
    EXPECT_LT(moved, 1e-4);
    EXPECT_LT(turned, 1e-3);
  }
  /// One that waits for consent.
  void start_hand_without_consent() {
    simulation_.emplace(start("simulation", {"safety.deadman=true"}));
    meet(commands_);
    ASSERT_TRUE(wait(20, [&] { return heard_ > 0 && gate_.deadman(); }));
  }
  bool moves(double limit_s) {
    base_speed_ = dof_speed_ = 0;
    return wait(limit_s, [&] { return base_speed_ > 0.02 || dof_speed_ > 0.05; });
  }
};

TEST_F(Stop, LatchesWhateverMappingDoesUntilTheRelease) {
  start_lab();
  const json stopped = ordered({"stop", "--reason", "a test"});
  EXPECT_EQ(stopped["done"], true);
  ASSERT_EQ(stopped["gates"].size(), 1u) << stopped;
  EXPECT_EQ(stopped["gates"][0]["hand"], "hand");
  EXPECT_EQ(stopped["gates"][0]["stopped"], true);
  EXPECT_TRUE(wait(20, [&] { return says("stopped by"); })) << status_.message().to_string();
  EXPECT_TRUE(gate_.stopped());
  EXPECT_EQ(gate_.reason().to_string(), "a test");
  EXPECT_NE(gate_.stopped_by().to_string().find("operator-"), std::string::npos)
      << gate_.stopped_by().to_string();

  expect_still(100);  // mapping goes on
  const std::uint64_t refused = dropped("command while stopped");
  EXPECT_TRUE(wait(20, [&] { return dropped("command while stopped") > refused; }));
  mapping_->signal(SIGSTOP);
  expect_still(100);
  mapping_->signal(SIGCONT);
  expect_still(100);
  mapping_->signal(SIGKILL);
  ASSERT_TRUE(mapping_->wait(seconds(5)));
  expect_still(100);
  mapping_.emplace(start("mapping"));
  const std::uint64_t before = dropped("command while stopped");
  EXPECT_TRUE(wait(20, [&] { return dropped("command while stopped") > before + 10; }));
  expect_still(100);
  const std::string page = order({"status", "--once"}).output;
  EXPECT_NE(page.find("STOPPED by"), std::string::npos) << page;

  base_speed_ = dof_speed_ = 0;
  const json released = ordered({"release", "--reason", "the test goes on"});
  EXPECT_EQ(released["gates"][0]["message"], "released");
  EXPECT_TRUE(moves(20));
  EXPECT_TRUE(wait(20, [&] { return status_.state() == v1::STATE_RUNNING; }));
  EXPECT_TRUE(wait(20, [&, first = heard_] { return heard_ > first + 100; }));
  // The gate's limits: 1.2 times what mapping and the joints (2.5 rad/s) may do.
  EXPECT_LE(base_speed_, 1.2 + 1e-6);
  EXPECT_LE(dof_speed_, 1.2 * 2.5 + 1e-6);
  EXPECT_FALSE(gate_.stopped());
}

TEST_F(Stop, ComesAgainAndIsSaidToBeThereAlready) {
  start_hand();
  EXPECT_EQ(ordered({"stop", "--reason", "one"})["gates"][0]["message"], "stopped; the hand holds");
  const std::string again = ordered({"stop", "--reason", "two"})["gates"][0]["message"];
  EXPECT_NE(again.find("stopped already, by"), std::string::npos) << again;
  EXPECT_NE(again.find("one"), std::string::npos) << again;
  EXPECT_EQ(ordered({"release", "--reason", "done"})["gates"][0]["message"], "released");
  EXPECT_EQ(ordered({"release", "--reason", "done"})["gates"][0]["message"], "was not stopped");
}

TEST_F(Stop, AnotherRigIsNamed) {
  start_hand();
  const auto from_elsewhere = [&](Strings words) {
    words = with_lab(std::move(words));
    words.insert(words.end(), {"--set", "lab.rig=" + name_ + "-elsewhere"});
    return run("prehend", words, 30);
  };
  EXPECT_EQ(from_elsewhere({"stop", "--timeout", "0.5"}).exit_code, 1);
  EXPECT_FALSE(gate_.stopped());
  const Answer stopped = from_elsewhere({"stop", "--rig", name_});
  EXPECT_EQ(stopped.exit_code, 0) << stopped.log;
  EXPECT_NE(stopped.output.find(name_ + "/hand: stopped"), std::string::npos) << stopped.output;
  EXPECT_TRUE(wait(20, [&] { return gate_.stopped(); }));
}

// On a domain of its own, of which nobody else knows.
TEST_F(Stop, AllRigsOfTheDomainStop) {
  start_hand();
  const Strings elsewhere{"lab.rig=" + name_ + "-b", "simulation.hand_name=other"};
  auto second = start("simulation", elsewhere);
  const auto gates_of = [](const json& answer) {
    std::set<std::string> gates;
    for (const json& gate : answer["gates"]) gates.insert(gate["hand"].get<std::string>());
    return gates;
  };
  const std::set<std::string> both{"hand", "other"};
  // The second one may not be there yet; who is stopped already says so.
  json answer;
  EXPECT_TRUE(eventually(30, [&] {
    answer =
        json::parse(order({"stop", "--all", "--reason", "both", "--json"}).output, nullptr, false);
    return answer.is_object() && gates_of(answer) == both && answer["done"] == true;
  })) << answer;
  for (const json& gate : answer["gates"]) EXPECT_EQ(gate["stopped"], true) << answer;
  EXPECT_TRUE(wait(20, [&] { return gate_.stopped(); }));
  const json released = ordered({"release", "--all", "--reason", "both again"});
  EXPECT_EQ(gates_of(released), both) << released;
}

// A refused order is repeated until it expires.
TEST_F(Stop, ARefusedOrderIsNotedOnce) {
  const std::string folder = (folder_ / "audit").string();
  start_hand({"safety.audit=" + folder});
  ordered({"takeover", "nobody", "--timeout", "1"}, 1);
  const Answer answer = order({"audit", "--set", "safety.audit=" + folder, "--json"});
  int noted = 0;
  const json document = json::parse(answer.output);
  for (const json& event : document["events"]) noted += event["event"] == "order_refused";
  EXPECT_EQ(noted, 1) << answer.output;
}

TEST_F(Stop, AReleaseNeedsAReasonAndAGate) {
  EXPECT_EQ(order({"release"}).exit_code, 2);
  EXPECT_EQ(order({"release", "--reason", ""}).exit_code, 2);
  EXPECT_EQ(order({"takeover"}).exit_code, 2);
  const Answer alone = order({"stop", "--timeout", "0.5"});
  EXPECT_EQ(alone.exit_code, 1) << alone.log;
  EXPECT_NE(alone.output.find("no gate answers"), std::string::npos) << alone.output;
}

// An order of long ago, as a recording has it, stops a robot but does not let it go.
TEST_F(Stop, OldOrdersStopButDoNotRelease) {
  start_hand();
  auto orders = writer(dds::operator_command);
  auto replies = reader(dds::operator_reply);
  meet(orders);
  const auto give = [&](const std::string& id, v1::OperatorAction action) {
    v1::OperatorCommand order;
    order.id(id.c_str());
    order.stamp_ns(now_ns() - 3'600'000'000'000);
    order.action(action);
    order.target("gate");
    order.argument("of then");
    // Again and again: the writer of the replies may not have met us yet.
    std::optional<v1::OperatorReply> reply;
    eventually(10, [&] {
      orders.write(order);
      reply = hear<v1::OperatorReply>(
          replies, 0.2, [&](const v1::OperatorReply& one) { return one.id().to_string() == id; });
      return reply.has_value();
    });
    return reply;
  };
  const auto stopped = give("stop", v1::ACTION_STOP);
  ASSERT_TRUE(stopped);
  EXPECT_TRUE(stopped->done());
  const auto released = give("release", v1::ACTION_RELEASE);
  ASSERT_TRUE(released);
  EXPECT_FALSE(released->done());
  EXPECT_TRUE(wait(20, [&] { return gate_.stopped(); }));
}

TEST_F(Stop, OpensTheHandWhereThatIsAsked) {
  start_hand({"safety.on_stop=open"});
  const auto closed = [&] {
    auto message = command(beginning);
    message.dof({0, 1, 1, 1});
    return message;
  };
  ASSERT_TRUE(send(commands_, 20, closed, [&] { return state_.dof()[1] > 0.95; }));
  EXPECT_EQ(ordered({"stop"})["gates"][0]["message"], "stopped; the hand opens");
  EXPECT_TRUE(send(commands_, 20, closed, [&] {
    return state_.dof()[1] < 0.02 && state_.dof()[2] < 0.02 && state_.dof()[3] < 0.02;
  }));
  EXPECT_LT((base() - beginning).norm(), 1e-3);
}

// An arm that accelerates more slowly than it brakes. It opens where the base has come to rest.
TEST_F(Stop, OpensWithoutTakingTheMovingBaseBack) {
  start_hand({"safety.on_stop=open", "gate.base_acceleration=2"});
  auto orders = writer(dds::operator_command);
  meet(orders);
  const auto away = [&] {
    auto message = command(beginning + Vector3d(3, 0, 0));
    message.dof({0, 1, 1, 1});
    return message;
  };
  base_speed_ = 0;
  ASSERT_TRUE(
      send(commands_, 20, away, [&] { return base_speed_ > 0.9 && state_.dof()[1] > 0.3; }));
  v1::OperatorCommand stop;
  stop.id("stop");
  stop.stamp_ns(now_ns());
  stop.action(v1::ACTION_STOP);
  stop.target("gate");
  orders.write(stop);
  const Vector3d then = base();
  double furthest = 0;
  EXPECT_TRUE(send(commands_, 20, away, [&] {
    furthest = std::max(furthest, (base() - then).norm());
    return state_.dof()[1] < 0.02 && state_.dof()[2] < 0.02 && state_.dof()[3] < 0.02;
  }));
  EXPECT_GT(furthest, 0.01) << "it was moving";
  EXPECT_NEAR((base() - then).norm(), furthest, 1e-3) << "the base went back";
  expect_still(50);
}

TEST_F(Stop, IsThereFromTheStartWhereThatIsAsked) {
  simulation_.emplace(start("simulation", {"safety.start_stopped=true"}));
  meet(commands_);
  ASSERT_TRUE(wait(20, [&] { return heard_ > 0; }));
  const Vector3d before = base();
  EXPECT_TRUE(send(
      commands_, 20, [&] { return command(beginning); },
      [&] { return dropped("command while stopped") > 20; }));
  EXPECT_EQ(base(), before);
  ordered({"release", "--reason", "all is clear"});
  EXPECT_TRUE(send(
      commands_, 20, [&] { return command(beginning); },
      [&] { return (base() - beginning).norm() < 1e-3; }));
}

// The stop is kept on disk: whoever starts the process anew does not release the hand.
TEST_F(Stop, OutlivesTheProcessOfTheRobot) {
  start_hand();
  ordered({"stop", "--reason", "a test"});
  simulation_->signal(SIGKILL);
  ASSERT_TRUE(simulation_->wait(seconds(5)));
  gate_ = {};
  status_ = {};
  simulation_.emplace(start("simulation"));
  meet(commands_);
  ASSERT_TRUE(wait(20, [&, first = heard_] { return heard_ > first + 5; }));
  const Vector3d before = base();
  EXPECT_TRUE(send(
      commands_, 20, [&] { return command(beginning); },
      [&] { return dropped("command while stopped") > 20; }));
  EXPECT_EQ(base(), before);
  EXPECT_TRUE(gate_.stopped());
  EXPECT_EQ(gate_.reason().to_string(), "a test");
  EXPECT_TRUE(says("stopped by operator-")) << status_.message().to_string();
  ordered({"release", "--reason", "all is clear"});
  EXPECT_TRUE(send(
      commands_, 20, [&] { return command(beginning); },
      [&] { return (base() - beginning).norm() < 1e-3; }));
  // And a release does so, too.
  simulation_->signal(SIGKILL);
  ASSERT_TRUE(simulation_->wait(seconds(5)));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "state"));
}

// A file that nobody understands is a stop; without a folder one is told.
TEST_F(Stop, WhatIsKeptAndCannotBeReadStopsAndWhatCannotBeKeptIsSaid) {
  start_hand();
  ordered({"stop"});
  simulation_->stop(seconds(5));
  listen();  // to its last words
  for (const auto& file : std::filesystem::directory_iterator(folder_ / "state"))
    ASSERT_TRUE(write_file(file.path(), "{"));
  gate_ = {};
  simulation_.emplace(start("simulation"));
  ASSERT_TRUE(wait(20, [&] { return gate_.stopped(); }));
  EXPECT_NE(gate_.reason().to_string().find("cannot be read"), std::string::npos);
  simulation_->stop(seconds(5));
  gate_ = {};
  simulation_.emplace(start("simulation", {"safety.state=/proc/nothing"}));
  ASSERT_TRUE(wait(20, [&] { return gate_.hand().size() > 0; }));
  EXPECT_FALSE(gate_.stopped());
  const std::string said = ordered({"stop"})["gates"][0]["message"];
  EXPECT_NE(said.find("until this process ends"), std::string::npos) << said;
}

// The space bar on a terminal, pressed as a keyboard repeats it.
TEST_F(Stop, TheHandMovesOnlyWhileTheDeadmanIsHeld) {
  start_hand_without_consent();
  Terminal terminal(program("prehend"), with_lab({"consent", "--hold"}));
  EXPECT_TRUE(terminal.shows("hold the space bar"));
  double angle = 0;
  const auto circling = [&] {
    angle += 0.03;
    return command(beginning + 0.1 * Vector3d(std::cos(angle), std::sin(angle), 0));
  };
  EXPECT_TRUE(send(
      commands_, 20,
      [&] {
        terminal.press(" ");
        return circling();
      },
      [&] { return gate_.consent() && status_.state() == v1::STATE_RUNNING; }))
      << status_.message().to_string();
  base_speed_ = 0;
  EXPECT_TRUE(send(
      commands_, 20,
      [&] {
        terminal.press(" ");
        return circling();
      },
      [&] { return base_speed_ > 0.05; }));
  // Let go: commands come all the same.
  EXPECT_TRUE(send(commands_, 20, circling, [&] { return !gate_.consent(); }));
  const Vector3d then = base();
  const std::uint64_t refused = dropped("command without consent");
  EXPECT_TRUE(send(commands_, 20, circling,
                   [&] { return dropped("command without consent") > refused + 50; }));
  EXPECT_LT((base() - then).norm(), 0.02);
  EXPECT_TRUE(says("the deadman is not held")) << status_.message().to_string();
  terminal.press("q");
  EXPECT_EQ(terminal.end(), 0);
}

TEST_F(Stop, ConsentIsHeldByScriptsForATimeOrWithAProcess) {
  start_hand_without_consent();
  EXPECT_EQ(order({"consent"}).exit_code, 2);
  EXPECT_EQ(order({"consent", "--hold"}).exit_code, 2) << "no terminal";
  auto process = start_program("prehend", with_lab({"consent", "--while-pid", "1"}));
  EXPECT_TRUE(wait(20, [&] { return gate_.consent(); }));
  process.signal(SIGKILL);
  EXPECT_TRUE(wait(20, [&] { return !gate_.consent(); })) << "it must not outlive who holds it";
  EXPECT_EQ(order({"consent", "--for", "0.3"}).exit_code, 0);
  EXPECT_TRUE(wait(20, [&] { return !gate_.consent(); }));
}

// Who led, stopped and let go is in the log, also when the service is killed.
TEST_F(Stop, TheAuditLogTellsWhoDidWhat) {
  const std::string folder = (folder_ / "audit").string();
  start_hand({"safety.audit=" + folder});
  ordered({"stop", "--reason", "a noise"});
  EXPECT_TRUE(send(
      commands_, 20, [&] { return command(beginning); },
      [&] { return dropped("command while stopped") > 10; }));
  ordered({"release", "--reason", "it was the door"});
  simulation_->signal(SIGKILL);
  ASSERT_TRUE(simulation_->wait(seconds(5)));
  const Answer answer = order({"audit", "--set", "safety.audit=" + folder, "--json"});
  ASSERT_EQ(answer.exit_code, 0) << answer.log;
  std::map<std::string, std::set<std::string>> events;
  const json document = json::parse(answer.output);
  int leads = 0, ends = 0;
  for (const json& event : document["events"]) {
    events[event["event"]].insert(event.value("what", ""));
    leads += event["event"] == "lead";
    ends += event["event"] == "lead_end";
    EXPECT_FALSE(events.contains("stop") && !events.contains("release") && leads > ends)
        << "nobody leads a hand that is stopped";
  }
  EXPECT_TRUE(events.contains("begin"));
  EXPECT_TRUE(events.contains("lead"));
  EXPECT_TRUE(events["stop"].contains("a noise")) << answer.output;
  EXPECT_TRUE(events["release"].contains("it was the door")) << answer.output;
  EXPECT_TRUE(events["refused"].contains("command while stopped")) << answer.output;
  EXPECT_EQ(order({"audit", folder + "/hand.jsonl"}).exit_code, 0);
  EXPECT_EQ(order({"audit"}).exit_code, 2) << "there is no log";
  EXPECT_EQ(order({"audit", folder + "/none.jsonl"}).exit_code, 3);
}

TEST_F(Stop, TheLeadIsTakenOverByName) {
  start_lab(patient);
  auto second = start("mapping");
  ASSERT_TRUE(wait(20, [&] { return gate_.refused().to_string().starts_with("mapping@"); }));
  const std::string first = gate_.leader().to_string(), other = gate_.refused().to_string();
  ordered({"takeover", "mapping"});
  EXPECT_TRUE(wait(20, [&] { return gate_.leader().to_string() == other; }))
      << gate_.leader().to_string();
  ordered({"takeover", first});
  EXPECT_TRUE(wait(20, [&] { return gate_.leader().to_string() == first; }));
  const json nobody = ordered({"takeover", "nobody", "--timeout", "1"}, 1);
  const std::string message = nobody["gates"][0]["message"];
  EXPECT_NE(message.find("does not send robot/command"), std::string::npos) << message;
  EXPECT_NE(message.find(first), std::string::npos) << message;
}

/// A recording that is played twice, by operators who do not know of each other.
class Replayers : public Stop {
 protected:
  stage::Process play(const std::string& topic) {
    return start_program(
        "prehend-replay",
        with_lab({test::in_sources("deploy/samples/intelligent-grasp.mcap"), "--quiet", "--stamps",
                  "now", "--rate", "0.5", "--topics", topic}));
  }
  static std::string name_of(const stage::Process& player) {
    return fmt::format("replayer@{}/{}", service::host_name(), player.pid());
  }
};

TEST_F(Replayers, OneOfTwoLeadsTheHandAndTheOtherIsRefusedAndNamed) {
  simulation_.emplace(start("simulation", patient));
  const auto first = play("robot/command");
  ASSERT_TRUE(wait(20, [&] { return gate_.leader().to_string() == name_of(first); }))
      << gate_.leader().to_string();
  const auto second = play("robot/command");
  EXPECT_TRUE(wait(20, [&] { return gate_.refused().to_string() == name_of(second); }))
      << gate_.refused().to_string();
  EXPECT_EQ(gate_.leader().to_string(), name_of(first));
  EXPECT_TRUE(wait(20, [&] { return says(name_of(second) + " is refused"); }))
      << status_.message().to_string();
  ordered({"takeover", "replayer"});
  EXPECT_TRUE(wait(20, [&] {
    return gate_.leader().to_string() == name_of(second) &&
           gate_.refused().to_string() == name_of(first);
  })) << gate_.leader().to_string();
}

TEST_F(Replayers, MappingFollowsOneOfTwoAndNamesTheOther) {
  simulation_.emplace(start("simulation", patient));
  mapping_.emplace(start("mapping", patient));
  const auto first = play("hand/posture");
  ASSERT_TRUE(wait(20, [&] { return gate_.leader().to_string().starts_with("mapping@"); }));
  const auto second = play("hand/posture");
  auto statuses = reader(dds::service_status);
  const auto words = [](const stage::Process& refused, const stage::Process& leads) {
    return fmt::format("hand/posture of {} is refused, for {} leads", name_of(refused),
                       name_of(leads));
  };
  // Where the machine lets the first one wait for 0.3 s, the second one leads.
  const std::set<std::string> either{words(second, first), words(first, second)};
  std::string said;
  EXPECT_TRUE(hear<v1::ServiceStatus>(statuses, 20, [&](const v1::ServiceStatus& status) {
    if (status.name().to_string() == "mapping") said = status.message().to_string();
    return either.contains(said);
  })) << said;
  const v1::HandState then = state_;
  EXPECT_TRUE(wait(20, [&] { return state_.origin_ns() > then.origin_ns(); })) << "it goes on";
}

}  // namespace
}  // namespace prehend::integration
