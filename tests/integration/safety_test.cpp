// The gate before a living robot: real processes, and commands of any kind written straight to the
// topic. What must not move the hand does not, base included, and the status says why.
#include <csignal>

#include "common/convert/convert.hpp"
#include "tests/integration/rig.hpp"
#include "tests/support/hands.hpp"

namespace prehend::integration {
namespace {

using Eigen::Vector3d;
using std::chrono::milliseconds;

const Vector3d beginning(0, -0.3, 0.5);  // of the base

class Safety : public Rig {
 protected:
  /// The hand open, its base at p.
  v1::HandCommand command(const Vector3d& p) {
    v1::HandCommand message;
    message.hand("hand");
    message.model("barrett");
    message.sequence_number(++sequence_);
    message.stamp_ns(now_ns());
    message.origin_ns(now_ns());
    message.dof({0, 0, 0, 0});
    message.X_WB(convert::to_message(make_pose(p)));
    return message;
  }
  void listen() {
    for (auto& sample : states_.take())
      if (!sample.info.gone) {
        state_ = sample.data;
        ++heard_;
      }
    for (auto& sample : statuses_.take())
      if (!sample.info.gone && sample.data.name().to_string() == "simulation")
        status_ = sample.data;
  }
  /// Sends what `next` makes every 20 ms until the condition holds.
  bool send(dds::Writer<v1::HandCommand>& writer, double limit_s,
            const std::function<v1::HandCommand()>& next, const std::function<bool()>& condition) {
    return eventually(limit_s, [&] {
      writer.write(next());
      std::this_thread::sleep_for(milliseconds(20));
      listen();
      return condition();
    });
  }
  Vector3d base() const { return convert::from_message(state_.X_WB().position()); }
  double total(const std::string& rate) const {
    for (const auto& one : status_.rates())
      if (one.name().to_string() == rate) return static_cast<double>(one.total());
    return 0;
  }
  std::uint64_t dropped(const std::string& reason) const {
    for (const auto& one : status_.drops())
      if (one.reason().to_string() == reason) return one.count();
    return 0;
  }
  bool says(const std::string& words) const {
    return status_.state() == v1::STATE_DEGRADED &&
           status_.message().to_string().find(words) != std::string::npos;
  }
  /// A simulation whose hand follows our commands.
  void start_hand(const Strings& sets = {}) {
    simulation_.emplace(start("simulation", sets));
    meet(commands_);
    ASSERT_TRUE(send(
        commands_, 30, [&] { return command(beginning); },
        [&] { return heard_ > 0 && (base() - beginning).norm() < 1e-3; }));
  }

  std::uint64_t sequence_ = 0;
  dds::Writer<v1::HandCommand> commands_ = writer(dds::robot_command);
  dds::Reader<v1::HandState> states_ = reader(dds::robot_state);
  dds::Reader<v1::ServiceStatus> statuses_ = reader(dds::service_status);
  v1::HandState state_;
  v1::ServiceStatus status_;
  int heard_ = 0;
  std::optional<service::Process> simulation_;
};

TEST_F(Safety, CommandsOfAnHourAgoDoNotMoveTheHandAndTheStatusSaysWhy) {
  start_hand();
  const auto old = [&] {
    auto message = command(beginning + Vector3d(0.3, 0, 0));
    message.stamp_ns(message.stamp_ns() - 3'600'000'000'000);
    return message;
  };
  EXPECT_TRUE(send(commands_, 20, old, [&] { return says("command too old"); }))
      << status_.message().to_string();
  EXPECT_GT(dropped("command too old"), 10u);
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
  ASSERT_TRUE(eventually(20, [&] { return listen(), heard_ > 0; }));
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
  v1::HandCommand kept = command(beginning);
  EXPECT_TRUE(eventually(30, [&] {
    y += 0.004;
    const auto older = command(beginning - Vector3d(0, 5, 0)),
               newer = command(beginning + Vector3d(0, y, 0));
    for (const v1::HandCommand& message : {newer, older, newer, kept}) {
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
  EXPECT_TRUE(eventually(5, [&] {
    listen();
    return dropped("command not newer than the last") > 50;
  }));
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
  EXPECT_TRUE(eventually(5, [&] {
    listen();
    return dropped("command cut: base speed") > 10;
  }));
}

TEST_F(Safety, ASecondWriterIsRefusedAndNamed) {
  start_hand();
  auto other = dds::Participant::create({.name = "other", .domain = domain_, .rig = name_});
  ASSERT_TRUE(other);
  auto second = other->writer(dds::robot_command);
  ASSERT_TRUE(second);
  meet(*second);
  EXPECT_TRUE(send(
      commands_, 20,
      [&] {
        second->write(command(beginning + Vector3d(0.5, 0, 0)));
        return command(beginning);
      },
      [&] { return says("is refused, for"); }))
      << status_.message().to_string();
  EXPECT_GT(dropped("command of a second writer"), 0u);
  EXPECT_LT((base() - beginning).norm(), 1e-3);
  EXPECT_EQ(total("leads"), 1);
  // The first falls silent: the second may lead.
  EXPECT_TRUE(send(
      *second, 20, [&] { return command(beginning + Vector3d(0.5, 0, 0)); },
      [&] { return base().x() > 0.49 && status_.state() == v1::STATE_RUNNING; }));
}

// As it happens: somebody starts a mapping that runs already.
TEST_F(Safety, ASecondMappingIsRefusedByNameUntilTheFirstIsGone) {
  const std::string stage = scene(1);
  simulation_.emplace(start("simulation", {"lab.scene=" + stage}));
  auto first = start("mapping");
  auto glove = start("glove", {"lab.scene=" + stage});
  ASSERT_TRUE(eventually(40, [&] { return listen(), total("leads") == 1; }));
  auto second = start("mapping");
  EXPECT_TRUE(eventually(20, [&] { return listen(), says("robot/command of mapping@"); }))
      << status_.message().to_string();
  EXPECT_NE(status_.message().to_string().find("for mapping@"), std::string::npos)
      << status_.message().to_string();
  EXPECT_EQ(total("leads"), 1);
  first.signal(SIGKILL);
  EXPECT_TRUE(eventually(20, [&] { return listen(), total("leads") == 2; }));
  EXPECT_TRUE(eventually(20, [&] { return listen(), status_.state() == v1::STATE_RUNNING; }))
      << status_.message().to_string();
}

}  // namespace
}  // namespace prehend::integration
