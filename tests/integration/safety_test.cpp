// The gate before a living robot: real processes, and commands of any kind written straight to the
// topic. What must not move the hand does not, base included, and the status says why.
#include <algorithm>
#include <csignal>
#include <limits>

#include "common/base/paths.hpp"
#include "common/model/hand_model.hpp"
#include "tests/integration/safety_rig.hpp"

namespace prehend::integration {
namespace {

using Eigen::Vector3d;
using std::chrono::milliseconds;

using Safety = SafetyRig;

TEST_F(Safety, CommandsOfAnHourAgoDoNotMoveTheHandAndTheStatusSaysWhy) {
  start_hand();
  const auto old = [&] {
    auto message = command(beginning + Vector3d(0.3, 0, 0));
    message.stamp_ns(message.stamp_ns() - 3'600'000'000'000);
    return message;
  };
  EXPECT_TRUE(send(commands_, 20, old, [&] {
    return says("command too old") && dropped("command too old") > 10;
  })) << status_.message().to_string();
  EXPECT_LT((base() - beginning).norm(), 1e-3);
  // With good ones it goes on.
  EXPECT_TRUE(send(
      commands_, 20, [&] { return command(beginning + Vector3d(0.3, 0, 0)); },
      [&] { return status_.state() == v1::STATE_RUNNING && base().x() > 0.29; }));
}

// A fresh world obeys them as little.
TEST_F(Safety, NobodyIsLedByWhatIsOldFromTheBeginning) {
  simulation_.emplace(start("simulation"));
  meet(commands_);
  ASSERT_TRUE(wait(20, [&] { return heard_ > 0; }));
  const Vector3d before = base();
  EXPECT_TRUE(send(
      commands_, 20,
      [&] {
        auto message = command(beginning);
        message.stamp_ns(message.stamp_ns() + 3'600'000'000'000);
        return message;
      },
      [&] { return says("command from the future"); }))
      << status_.message().to_string();
  EXPECT_LT((base() - before).norm(), 1e-9);
}

TEST_F(Safety, DoubledAndSwappedCommandsAreIgnored) {
  start_hand();
  double y = 0, back = 0;  // furthest way against the stream
  v2::HandCommand kept = command(beginning);
  EXPECT_TRUE(eventually(30, [&] {
    y += 0.004;
    const auto older = command(beginning - Vector3d(0, 5, 0)),
               newer = command(beginning + Vector3d(0, y, 0));
    for (const v2::HandCommand& message : {newer, older, newer, kept}) {
      commands_.write(message);
      std::this_thread::sleep_for(milliseconds(5));
    }
    kept = older;
    const double before = base().y();
    listen();
    back = std::max(back, before - base().y());
    return y > 0.3 && base().y() > beginning.y() + 0.29;
  }));
  EXPECT_LT(back, 1e-3);
  EXPECT_TRUE(wait(20, [&] { return dropped("command not newer than the last") > 50; }));
}

// Leaps are cut to the speed of the gate, not refused.
TEST_F(Safety, ALeapIsCutToTheLimits) {
  start_hand({"gate.base_speed=0.2"});
  const auto begun = std::chrono::steady_clock::now();
  EXPECT_TRUE(send(
      commands_, 30, [&] { return command(beginning + Vector3d(0.4, 0, 0)); },
      [&] { return base().x() > 0.39; }));
  // 0.4 m at 0.2 m/s, of which 300 ms may be in reserve.
  EXPECT_GT(std::chrono::steady_clock::now() - begun, milliseconds(1600));
  EXPECT_TRUE(wait(20, [&] { return dropped("command cut: base speed") > 10; }));
}

// Efforts that cannot be meant are refused, those beyond the limit are cut, and the drives keep to
// it whatever a command says, or does not say.
TEST_F(Safety, EffortsAreRefusedOrCutAndCounted) {
  EXPECT_EQ(run("prehend-simulation", lab_arguments({"gate.effort=1.5"}), 20).exit_code, 2);
  start_hand({"gate.effort=0.25"});
  const double infinity = std::numeric_limits<double>::infinity();
  for (const auto& [effort, reason] :
       {std::pair(std::numeric_limits<double>::quiet_NaN(), "command not finite"),
        std::pair(infinity, "command not finite"), std::pair(-infinity, "command not finite"),
        std::pair(-0.1, "command outside limits")}) {
    const auto before = dropped(reason);
    EXPECT_TRUE(send(
        commands_, 20,
        [&] {
          auto message = command(beginning + Vector3d(0.3, 0, 0));
          message.effort({0.1, 0.1, effort, 0.1});
          return message;
        },
        [&] { return says(reason) && dropped(reason) > before + 10; }))
        << effort << ": " << status_.message().to_string();
    EXPECT_LT((base() - beginning).norm(), 1e-3) << effort;
  }
  const auto model = model::HandModel::load(share_directory() / "models/hands" / "barrett").value();
  const auto are_counted = [&] {
    return dropped("command cut: effort") > 10 &&
           std::ranges::any_of(gate_.counts(), [](const v1::GateCount& count) {
             return count.reason().to_string() == "command cut: effort" && count.count() > 10;
           });
  };
  double most = 0;  // share of what the drives have
  for (const std::vector<double>& effort : {std::vector<double>(), std::vector<double>(4, 100)}) {
    const double closure = effort.empty() ? 0.6 : 1.2;
    EXPECT_TRUE(send(
        commands_, 30,
        [&] {
          auto message = command(beginning);
          message.dof({0, closure, closure, closure});
          message.effort(effort);
          return message;
        },
        [&] {
          for (std::size_t i = 0; i < model.joints().size(); ++i)
            most = std::max(most, std::abs(state_.torque()[i]) / model.joints()[i].max_torque);
          return state_.dof()[1] > closure - 0.05 && (effort.empty() || are_counted());
        }))
        << closure;
  }
  EXPECT_GT(most, 0);
  EXPECT_LT(most, 0.25 + 1e-9);
}

TEST_F(Safety, ASecondWriterIsRefusedAndNamed) {
  start_hand(patient);
  auto other = dds::Participant::create({.name = "other", .domain = domain_, .rig = name_});
  ASSERT_TRUE(other);
  auto second = other->writer(dds::robot_command);
  ASSERT_TRUE(second);
  meet(*second);
  EXPECT_TRUE(send(
      *second, 20,
      [&] {
        commands_.write(command(beginning));
        return command(beginning + Vector3d(0.5, 0, 0));
      },
      [&] { return says("is refused, for"); }))
      << status_.message().to_string();
  EXPECT_GT(dropped("command of a second writer"), 0u);
  EXPECT_LT((base() - beginning).norm(), 1e-3);
  EXPECT_EQ(total("leads"), 1u);
  // The first falls silent: the second may lead.
  EXPECT_TRUE(send(
      *second, 20, [&] { return command(beginning + Vector3d(0.5, 0, 0)); },
      [&] { return base().x() > 0.49 && status_.state() == v1::STATE_RUNNING; }));
}

// As it happens: somebody starts a mapping that runs already.
TEST_F(Safety, ASecondMappingIsRefusedByNameUntilTheFirstIsGone) {
  start_lab(patient);
  auto second = start("mapping");
  EXPECT_TRUE(wait(20, [&] { return says("robot/command of mapping@"); }))
      << status_.message().to_string();
  EXPECT_NE(status_.message().to_string().find("for mapping@"), std::string::npos)
      << status_.message().to_string();
  EXPECT_EQ(total("leads"), 1u);
  mapping_->signal(SIGKILL);
  EXPECT_TRUE(wait(20, [&] { return total("leads") == 2; }));
  EXPECT_TRUE(wait(20, [&] { return status_.state() == v1::STATE_RUNNING; }))
      << status_.message().to_string();
}

}  // namespace
}  // namespace prehend::integration
