// The real process over real DDS: commands at 30 Hz reach for an object that was only seen, close
// and lift; the report comes while the world goes on, and commands that cannot be followed are
// counted.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <optional>
#include <prehend/base/paths.hpp>
#include <prehend/dds/convert.hpp>
#include <prehend/dds/participant.hpp>
#include <prehend/model/hand_model.hpp>
#include <random>
#include <thread>

// Inside prehend, because the DDS library has a global namespace dds of its own.
namespace prehend {
namespace {

using Eigen::Vector3d;

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

struct Process {
  pid_t pid = -1;
  explicit Process(int domain) {
    const std::string program = (program_directory() / "prehend-simulation").string();
    const std::string setting = "lab.domain=" + std::to_string(domain);
    pid = ::fork();
    if (pid == 0) {
      ::execl(program.c_str(), program.c_str(), "--set", setting.c_str(), nullptr);
      ::_exit(127);
    }
  }
  /// Exit code after SIGTERM, -1 if it did not end by itself.
  int stop() {
    if (pid < 0) return -1;
    ::kill(pid, SIGTERM);
    int status = 0;
    ::waitpid(pid, &status, 0);
    pid = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  ~Process() { stop(); }
};

v1::HandCommand command(const model::HandModel& hand, const Vector3d& p_WG, double closure) {
  Eigen::Matrix3d R;  // palm along y, its x axis up
  R.col(0) = Vector3d::UnitZ();
  R.col(2) = Vector3d::UnitY();
  R.col(1) = R.col(2).cross(R.col(0));
  v1::HandCommand message;
  message.hand("hand");
  message.model("barrett");
  message.stamp_ns(now_ns());
  message.origin_ns(now_ns());
  message.dof({0, closure, closure, closure});
  message.X_WB(dds::to_message(make_pose(p_WG, R) * hand.X_BG().inverse()));
  message.mode(v1::MODE_DIRECT);
  return message;
}

TEST(SimulationProcess, GraspsWhatWasSeenAndReportsIt) {
  const auto hand =
      model::HandModel::load(std::string(PREHEND_SOURCE) + "/common/models/hands/barrett");
  ASSERT_TRUE(hand);
  const int domain = static_cast<int>(100 + std::random_device{}() % 100);
  auto lab = dds::Participant::create({.name = "test", .domain = domain, .rig = "lab"});
  ASSERT_TRUE(lab) << lab.error().message();
  auto commands = lab->writer(dds::robot_command);
  auto detections = lab->writer(dds::object_detection);
  auto states = lab->reader(dds::robot_state);
  auto objects = lab->reader(dds::object_state);
  auto reports = lab->reader(dds::grasp_report);
  auto statuses = lab->reader(dds::service_status);
  ASSERT_TRUE(commands && detections && states && objects && reports && statuses);
  Process process(domain);

  const auto tick = std::chrono::milliseconds(33);
  int seen_states = 0;
  for (int i = 0; i < 300 && seen_states == 0; ++i) {
    std::this_thread::sleep_for(tick);
    seen_states += static_cast<int>(states->take().size());
  }
  ASSERT_GT(seen_states, 0) << "the process does not publish robot/state";

  v1::ObjectDetection detection;
  detection.name("Talc");
  detection.shape(v1::SHAPE_CYLINDER);
  detection.size(dds::to_message(Vector3d(0.024, 0.024, 0.105)));
  detection.X_WO(dds::to_message(make_pose(Vector3d(0, 0, 0.05))));
  detection.stamp_ns(now_ns());
  ASSERT_TRUE(detections->write(detection));

  std::optional<v1::GraspReport> report;
  double height = 0;
  for (int i = 0; i < 180; ++i) {
    const double t = i / 30.0 - 1;  // a second for the sight to arrive
    const double reach = std::clamp(t / 1.2, 0.0, 1.0),
                 close = std::clamp((t - 1.4) / 0.8, 0.0, 1.0);
    const double lift = 0.12 * std::clamp((t - 3.5) / 0.8, 0.0, 1.0);
    auto message = command(*hand, Vector3d(0, -0.25 * (1 - reach), 0.06 + lift), 1.4 * close);
    if (i % 30 == 1) {  // nonsense now and then
      auto wrong = message;
      wrong.dof({0, 0});
      commands->write(wrong);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      wrong = message;
      wrong.X_WB().position().x(std::nan(""));
      commands->write(wrong);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    commands->write(message);
    std::this_thread::sleep_for(tick);
    for (auto& sample : reports->take())
      if (!report) report = sample.data;
    for (auto& sample : objects->take())
      if (!sample.info.gone) height = sample.data.X_WO().position().z();
  }
  ASSERT_TRUE(report) << "no grasp/report";
  EXPECT_EQ(report->object().to_string(), "Talc");
  EXPECT_TRUE(report->held()) << report->reason().to_string();
  EXPECT_TRUE(report->force_closure());
  EXPECT_GT(report->epsilon(), 0);
  EXPECT_GE(report->contacts().size(), 3u);
  EXPECT_GT(height, 0.12);  // the living world has lifted it too

  std::uint64_t wrong_length = 0, not_finite = 0;
  bool has_latency = false;
  for (int i = 0; i < 60 && wrong_length == 0; ++i) {
    std::this_thread::sleep_for(tick);
    for (auto& sample : statuses->take()) {
      for (const auto& drop : sample.data.drops()) {
        if (drop.reason().to_string() == "command of wrong length") wrong_length = drop.count();
        if (drop.reason().to_string() == "command not finite") not_finite = drop.count();
      }
      for (const auto& stage : sample.data.latency())
        has_latency |= stage.stage().to_string() == "glove to accepted" && stage.count() > 0;
    }
  }
  EXPECT_GT(wrong_length, 0u);
  EXPECT_GT(not_finite, 0u);
  EXPECT_TRUE(has_latency);
  EXPECT_EQ(process.stop(), 0);
}

}  // namespace
}  // namespace prehend
