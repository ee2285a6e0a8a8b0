// Every process is killed in turn, as by a power cut, and started again: what it does must flow
// within 2 s of its restart, without anybody else being touched.
#include <csignal>

#include "tests/integration/rig.hpp"

namespace prehend::integration {
namespace {

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

  /// Seconds from the restart until a sample of `reader` tells of something newer; -1: too late.
  template <class T>
  double recovery(const std::string& name, dds::Reader<T>& reader,
                  const std::function<std::int64_t(const T&)>& time) {
    processes_.at(name).signal(SIGKILL);
    EXPECT_TRUE(processes_.at(name).wait(seconds(5)));
    reader.take();
    const std::int64_t restart = now_ns();
    processes_.insert_or_assign(name, start(name, sets_));
    const auto heard = hear<T>(reader, 10, [&](const T& sample) { return time(sample) > restart; });
    const double took = heard ? static_cast<double>(now_ns() - restart) * 1e-9 : -1;
    std::cout << name << " back after " << took << " s\n";
    for (auto& [other, process] : processes_) EXPECT_FALSE(process.exit()) << other << " ended";
    return took;
  }

  Strings sets_;
  std::map<std::string, service::Process> processes_;
  dds::Reader<v1::HandPosture> postures_ = reader(dds::hand_posture);
  dds::Reader<v2::HandCommand> commands_ = reader(dds::robot_command);
  dds::Reader<v1::HandState> states_ = reader(dds::robot_state);
  dds::Reader<v1::ObjectDetection> detections_ = reader(dds::object_detection);
};

constexpr double limit = 2.0;  // s, of the issue that asked for it

// The effect in the world is waited for, not only the restarted process's own output: its
// neighbours must have found it again.
TEST_F(Recovery, Glove) {
  const double took =
      recovery<v1::HandState>("glove", states_, [](auto& s) { return s.origin_ns(); });
  EXPECT_GT(took, 0);
  EXPECT_LT(took, limit);
}

TEST_F(Recovery, Mapping) {
  const double took =
      recovery<v1::HandState>("mapping", states_, [](auto& s) { return s.origin_ns(); });
  EXPECT_GT(took, 0);
  EXPECT_LT(took, limit);
}

TEST_F(Recovery, Simulation) {
  const double took =
      recovery<v1::HandState>("simulation", states_, [](auto& s) { return s.origin_ns(); });
  EXPECT_GT(took, 0);
  EXPECT_LT(took, limit);
}

TEST_F(Recovery, Recognition) {
  const double took = recovery<v1::ObjectDetection>("recognition", detections_,
                                                    [](auto& d) { return d.stamp_ns(); });
  EXPECT_GT(took, 0);
  EXPECT_LT(took, limit);
}

TEST_F(Recovery, WithoutAGloveTheHandHoldsStill) {
  processes_.at("glove").signal(SIGKILL);
  ASSERT_TRUE(processes_.at("glove").wait(seconds(5)));
  ASSERT_TRUE(
      hear<v2::HandCommand>(commands_, 10, [](auto& c) { return c.mode() == v1::MODE_HOLD; }) ||
      commands_.take().empty());
  // The joints come to rest at what was last commanded, and stay there.
  const auto at_rest = [](const v1::HandState& state) {
    return std::all_of(state.velocity().begin(), state.velocity().end(),
                       [](double v) { return std::abs(v) < 0.01; });
  };
  const auto rest = hear<v1::HandState>(states_, 10, at_rest);
  ASSERT_TRUE(rest);
  const std::int64_t later = rest->stamp_ns() + 1'000'000'000;
  const auto after =
      hear<v1::HandState>(states_, 10, [&](auto& s) { return s.stamp_ns() > later; });
  ASSERT_TRUE(after);
  ASSERT_EQ(after->dof().size(), rest->dof().size());
  for (std::size_t i = 0; i < rest->dof().size(); ++i)
    EXPECT_NEAR(after->dof()[i], rest->dof()[i], 0.02) << "rad, DoF " << i;
}

}  // namespace
}  // namespace prehend::integration
