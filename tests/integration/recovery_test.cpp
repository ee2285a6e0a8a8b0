// Every process is killed in turn, as by a power cut, and started again: what it does must flow
// before the dead one's lease has run out, without anybody else being touched. How fast that is on
// a quiet machine, the table of integration_faults tells.
#include <Eigen/Core>
#include <csignal>

#include "tests/integration/rig.hpp"
#include "tests/integration/stillness.hpp"

namespace prehend::integration {
namespace {

constexpr double lease = 20;      // s, for which who is killed is taken for one who is there
constexpr double max_rest = 2.5;  // s, of the synthetic hand: while it holds an object

class Recovery : public Rig {
 protected:
  void SetUp() override {
    const std::string truth = "lab.scene=" + scene(1);
    sets_ = {truth, "glove.device=synthetic"};
    for (const char* name : {"recognition", "mapping", "simulation", "glove"})
      processes_.emplace(name, start(name, sets_));
    // The whole chain: the world has accepted what a glove frame caused.
    ASSERT_TRUE(hear<v1::HandState>(states_, 30, [](auto& s) { return s.origin_ns() > 0; }));
    ASSERT_TRUE(hear<v1::ObjectDetection>(detections_, 30, [](auto&) { return true; }));
  }

  /// A sample of `reader` that tells of something newer than the restart comes, although those who
  /// are there still take the dead one for one of them.
  template <class T>
  void expect_recovery(const std::string& name, dds::Reader<T>& reader,
                       const std::function<std::int64_t(const T&)>& time) {
    processes_.at(name).signal(SIGKILL);
    EXPECT_TRUE(processes_.at(name).wait(seconds(5)));
    reader.take();
    const std::int64_t restart = now_ns();
    processes_.insert_or_assign(name, start(name, sets_));
    EXPECT_TRUE(
        hear<T>(reader, 0.75 * lease, [&](const T& sample) { return time(sample) > restart; }))
        << name << " is not back";
    std::cout << name << " back after " << 1e-9 * static_cast<double>(now_ns() - restart) << " s\n";
    for (auto& [other, process] : processes_) EXPECT_FALSE(process.exit()) << other << " ended";
  }
  /// So many seconds in a row, by the hand's own time. Keeps what it is told meanwhile.
  bool stands_still(double seconds) {
    Stillness seen;
    std::int64_t begin = 0;
    const auto goes_on = [&](const v1::HandState& state) {
      for (const auto& sample : commands_.take())
        if (!sample.info.gone) told_.push_back(sample.data);
      seen.add(state);
      if (seen.complaint(0)) {  // it has moved: once more from here
        seen = {};
        seen.add(state);
        begin = state.stamp_ns();
      }
      return static_cast<double>(state.stamp_ns() - begin) > seconds * 1e9;
    };
    return hear<v1::HandState>(states_, 40, goes_on).has_value();
  }

  Strings sets_;
  std::vector<v2::HandCommand> told_;
  std::map<std::string, stage::Process> processes_;
  dds::Reader<v2::HandCommand> commands_ = reader(dds::robot_command);
  dds::Reader<v1::HandState> states_ = reader(dds::robot_state);
  dds::Reader<v1::ObjectDetection> detections_ = reader(dds::object_detection);
};

// The effect in the world is waited for, not only the restarted process's own output: its
// neighbours must have found it again.
TEST_F(Recovery, Glove) {
  expect_recovery<v1::HandState>("glove", states_, [](auto& s) { return s.origin_ns(); });
}

TEST_F(Recovery, Mapping) {
  expect_recovery<v1::HandState>("mapping", states_, [](auto& s) { return s.origin_ns(); });
}

TEST_F(Recovery, Simulation) {
  expect_recovery<v1::HandState>("simulation", states_, [](auto& s) { return s.origin_ns(); });
}

TEST_F(Recovery, Recognition) {
  expect_recovery<v1::ObjectDetection>("recognition", detections_,
                                       [](auto& d) { return d.stamp_ns(); });
}

// The glove ends while it leads the hand on a way.
TEST_F(Recovery, WithoutAGloveTheHandHoldsStill) {
  std::optional<Eigen::Vector3d> first;
  ASSERT_TRUE(hear<v1::HandState>(states_, 40, [&](const v1::HandState& state) {
    const auto& p = state.X_WB().position();
    const Eigen::Vector3d base(p.x(), p.y(), p.z());
    if (!first) first = base;
    return (base - *first).norm() > 0.05;
  })) << "the glove does not move the hand";
  processes_.at("glove").signal(SIGKILL);
  ASSERT_TRUE(processes_.at("glove").wait(seconds(5)));
  const std::int64_t killed = now_ns();
  const auto hold = hear<v2::HandCommand>(commands_, 20, [&](const v2::HandCommand& command) {
    return command.stamp_ns() > killed && command.mode() == v1::MODE_HOLD;
  });
  ASSERT_TRUE(hold) << "nobody tells the hand to hold";
  EXPECT_TRUE(stands_still(max_rest + 1));
  EXPECT_FALSE(told_.empty());
  for (const v2::HandCommand& command : told_) {
    EXPECT_EQ(command.mode(), v1::MODE_HOLD);
    EXPECT_EQ(command.dof(), hold->dof());
    EXPECT_EQ(command.X_WB(), hold->X_WB());
  }
}

}  // namespace
}  // namespace prehend::integration
