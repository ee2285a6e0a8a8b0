// What breaks in a laboratory, done to a lab that is spread over hosts. Whatever the fault:
//   no process ends but the one that was killed; orders, their answers and reports of grasps are
//   not lost; the hand holds still meanwhile; and a new frame of the glove moves it again within
//   1 s of the fault's end, within 0.5 s of the start of a process that was killed. Over many
//   rounds the 0.5 s are the median's, and 2 s each one's. That is measured (PREHEND_LONG); a
//   machine that others load may take five times as long.
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tests/integration/fault_rig.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::integration {
namespace {

constexpr double healed = 1.0;     // s, after a fault of the network
constexpr double restarted = 0.5;  // s, after a start
constexpr double slowest = 2.0;    // s, the same on a machine that has no time

class Faults : public FaultRig {
 protected:
  void SetUp() override {
    FaultRig::SetUp();
    if (!hosts_) return;
    for (const char* host : {"hand", "eye", "robot"}) hosts_->add(host);
    start_lab();
  }

  /// Nothing moves any more from `after` s into a fault of `length` s.
  void expect_still(double after, double length) {
    operate(after);
    stillness_ = {};
    operate(length - after);
    const auto complaint = stillness_.complaint(length - after);
    EXPECT_FALSE(complaint) << "while nobody led it: " << *complaint;
  }

  void expect_degraded(const std::string& service, const std::string& words) {
    EXPECT_TRUE(operate(20,
                        [&] {
                          const auto& status = statuses_[service];
                          return status.state() == v1::STATE_DEGRADED &&
                                 status.message().to_string().find(words) != std::string::npos;
                        }))
        << service << " says: " << statuses_[service].message().to_string();
  }

  /// The command `prehend` on a host, to its end.
  Answer run_on(const std::string& host, Strings arguments) {
    static int count = 0;
    arguments.insert(arguments.begin(), program("prehend"));
    for (const std::string& argument : lab_arguments()) arguments.push_back(argument);
    const auto output = folder_ / ("out-" + std::to_string(++count));
    auto process = stage::Process::start(
        {.command = hosts_->on(host, arguments), .log = folder_ / "command.log", .output = output});
    if (!process) throw std::runtime_error(process.error().message());
    std::optional<stage::Process::Exit> exit;
    operate(20, [&] { return (exit = process->exit()).has_value(); });
    std::ifstream stream(output);
    return {exit ? exit->code : -1, {std::istreambuf_iterator<char>(stream), {}}, ""};
  }

  /// The glove's clock minus the robot's, s, as `prehend status --json` has it.
  static double apart(const std::string& json) {
    const auto document = nlohmann::json::parse(json, nullptr, false);
    double glove = 0, mapping = 0;
    if (document.is_object())
      for (const auto& service : document["services"]) {
        if (service["state"] != "running" || service["clock"].is_null()) continue;
        if (service["name"] == "glove") glove = service["clock"]["offset_s"];
        if (service["name"] == "mapping") mapping = service["clock"]["offset_s"];
      }
    return glove - mapping;
  }

  /// Ends a service that runs and starts it as it was in the beginning.
  void renew(const std::string& name, const Strings& sets = {}, const std::string& log = {}) {
    const std::uint64_t lost = unanswered();  // who has ended answers nothing any more
    EXPECT_EQ(lost, 0u);
    orders_ = false;
    processes_.at(name).stop(seconds(5));
    const std::int64_t start = now_ns();
    processes_.insert_or_assign(name, launch(name, {}, sets, log));
    EXPECT_GT(recovery(start), 0);
    resume_orders();
  }

  void cable_pulled();
  void five_percent_lost();
  void late_joiners();
  void killed_and_restarted();
  void two_leaders();
  void full_disk();
  void clocks_an_hour_apart();
  void what_is_lost_is_said();
};

// One lab bears them all: it must be as before after each.
TEST_F(Faults, OneAfterTheOther) {
  const auto bear = [](const char* what, const std::function<void()>& fault) {
    SCOPED_TRACE(what);
    const std::int64_t begin = now_ns();
    fault();
    std::cout << what << ": " << (now_ns() - begin) / 1'000'000 << " ms" << std::endl;
  };
  bear("late joiners", [this] { late_joiners(); });
  bear("cable pulled", [this] { cable_pulled(); });
  bear("five percent lost", [this] { five_percent_lost(); });
  bear("two leaders", [this] { two_leaders(); });
  bear("full disk", [this] { full_disk(); });
  // A round for each process is in integration_recovery.
  if (rounds(0, 1)) bear("killed and restarted", [this] { killed_and_restarted(); });
  bear("what is lost is said", [this] { what_is_lost_is_said(); });
}

constexpr const char* faketime = "/usr/lib/x86_64-linux-gnu/faketime/libfaketimeMT.so.1";

// A case of its own: where it cannot be tried it is skipped, and nobody takes it for passed.
TEST_F(Faults, ClocksAnHourApart) {
  if (!std::filesystem::exists(faketime)) GTEST_SKIP() << "libfaketime is not installed";
  clocks_an_hour_apart();
}

void Faults::cable_pulled() {
  FaultRow row = begin("cable pulled");
  const double length = rounds(5, 10);
  for (row.rounds = 0; row.rounds < rounds(1, 10); ++row.rounds) {
    hosts_->link("hand", false);
    expect_still(promised(0.7), length);
    hosts_->link("hand", true);
    expect_recovery(row, healed);
  }
  // The operator's own cable: orders wait in the writer, answers in the mapping's.
  hosts_->link("operator", false);
  operate(length);
  hosts_->link("operator", true);
  expect_recovery(row, healed);
  ++row.rounds;
  finish(row);
}

void Faults::five_percent_lost() {
  FaultRow row = begin("5 % of packets lost");
  for (const char* host : {"hand", "eye", "robot", "operator"}) hosts_->lose(host, 0.05);
  // Meanwhile the hand goes on, up to what this machine does without a fault.
  const double longest = max_pause(rounds(3, 60));
  for (const char* host : {"hand", "eye", "robot", "operator"}) hosts_->lose(host, 0);
  EXPECT_LT(longest, 1.0 + 2 * undisturbed_) << "s without a frame";
  row.rounds = 1;
  expect_recovery(row, healed);
  finish(row);
}

void Faults::killed_and_restarted() {
  for (const std::string name : {"glove", "recognition", "mapping", "simulation"}) {
    FaultRow row = begin("killed: " + name);
    for (row.rounds = 0; row.rounds < rounds(1, 100); ++row.rounds) {
      row.lost += unanswered();  // who is killed answers nothing any more
      orders_ = name != "mapping";
      processes_.at(name).signal(SIGKILL);
      ASSERT_TRUE(processes_.at(name).wait(seconds(5)));
      const std::int64_t killed = now_ns();
      operate(0.3);
      if (name == "recognition") {
        EXPECT_TRUE(operate(15, [&] { return moved_by_ > killed; }));
      }
      const std::int64_t start = now_ns();
      processes_.insert_or_assign(name, launch(name));
      const auto status = [&] { return statuses_[name].stamp_ns() > start; };
      const double took =
          name == "recognition"
              ? (operate(15, status) ? 1e-9 * static_cast<double>(now_ns() - start) : -1)
              : recovery(start);
      row.recoveries.push_back(took);
      EXPECT_GT(took, 0) << name;
      EXPECT_LT(took, promised(slowest)) << name;
      resume_orders();
    }
    std::sort(row.recoveries.begin(), row.recoveries.end());
    if (row.rounds > 10) {
      EXPECT_LT(row.recoveries[row.recoveries.size() / 2], restarted) << name;
    }
    finish(row);
  }
}

void Faults::what_is_lost_is_said() {
  processes_.at("glove").signal(SIGKILL);
  ASSERT_TRUE(processes_.at("glove").wait(seconds(5)));
  expect_degraded("mapping", "hand/posture");
  expect_still(0.1, 1);
  processes_.at("mapping").signal(SIGKILL);
  ASSERT_TRUE(processes_.at("mapping").wait(seconds(5)));
  orders_ = false;
  expect_degraded("simulation", "robot/command");
  processes_.clear();
}

// Two mappings, as after a mistake, or a mapping and a recording that is played: the gate lets one
// of them lead the hand, and the other takes over when that one dies.
void Faults::two_leaders() {
  const auto commands_a_second = [&] {
    for (const auto& rate : statuses_["simulation"].rates())
      if (rate.name().to_string() == "commands") return rate.per_second();
    return 0.0;
  };
  FaultRow row = begin("second mapping");
  processes_.insert_or_assign("second mapping", launch("mapping", {}, {}, "second-mapping"));
  orders_ = false;  // both would obey
  operate(1.5);
  const std::uint64_t leads_before = leads();
  operate(2);
  EXPECT_EQ(leads(), leads_before) << "the lead changed hands";
  EXPECT_GT(leads(), 0u);
  EXPECT_LT(commands_a_second(), 45) << "a glove of 30 Hz, and both lead";
  for (const std::string victim : {"mapping", "second mapping"}) {
    processes_.at(victim).signal(SIGKILL);
    ASSERT_TRUE(processes_.at(victim).wait(seconds(5)));
    row.recoveries.push_back(recovery(now_ns()));
    EXPECT_GT(row.recoveries.back(), 0) << "nobody leads after the end of the " << victim;
    EXPECT_LT(row.recoveries.back(), promised(slowest));
    processes_.insert_or_assign(victim, launch("mapping", {}, {}, "again"));
    operate(2);
    ++row.rounds;
  }
  processes_.erase("second mapping");
  row.recoveries.push_back(recovery(now_ns()));
  EXPECT_GT(row.recoveries.back(), 0);

  Strings replay = hosts_->on(
      "eye", {program("prehend-replay"), test::in_sources("deploy/samples/intelligent-grasp.mcap"),
              "--topics", "robot/command", "--loop", "--stamps", "now"});
  for (const std::string& argument : lab_arguments()) replay.push_back(argument);
  auto player = stage::Process::start({.command = replay, .log = folder_ / "replay.log"});
  ASSERT_TRUE(player);
  ASSERT_TRUE(operate(15, [&] { return statuses_.contains("replayer"); }));
  operate(1.5);
  const std::uint64_t leads_with_player = leads();
  operate(2);
  EXPECT_EQ(leads(), leads_with_player) << "the lead changed hands";
  player->stop(seconds(5));
  statuses_.erase("replayer");
  row.recoveries.push_back(recovery(now_ns()));
  EXPECT_GT(row.recoveries.back(), 0);
  ++row.rounds;
  resume_orders();
  finish(row);
}

void Faults::full_disk() {
  FaultRow row = begin("disk full");
  // What a service says goes nowhere, and the recorder's disk takes 1 MB.
  for (const char* name : {"glove", "mapping"}) renew(name, {"glove.rate=100"}, "/dev/full");
  const auto disk = folder_ / "disk";
  std::filesystem::create_directory(disk);
  Strings record =
      hosts_->on("eye", {"unshare", "--mount", "sh", "-c",
                         "mount -t tmpfs -o size=1m none \"$0\" && exec \"$@\"", disk.string(),
                         program("prehend-record"), "-o", (disk / "lab.mcap").string(),
                         "--compression", "none", "--keep-free", "0", "--duration", "20"});
  for (const std::string& argument : lab_arguments()) record.push_back(argument);
  auto recorder = stage::Process::start({.command = record, .log = folder_ / "record.log"});
  ASSERT_TRUE(recorder);
  std::optional<stage::Process::Exit> exit;
  operate(30, [&] { return (exit = recorder->exit()).has_value(); });
  ASSERT_TRUE(exit) << "the recorder hangs";
  EXPECT_EQ(exit->signal, 0) << "it must not crash";
  EXPECT_NE(exit->code, 0) << "a recording with a hole is no success";
  const std::string said = stage::last_lines(folder_ / "record.log", 20);
  EXPECT_NE(said.find("space"), std::string::npos) << said;
  row.rounds = 1;
  expect_recovery(row, healed);
  finish(row);
  for (const char* name : {"glove", "mapping"}) renew(name);
}

/// Runs a program by a clock of its own; the file holds how far that is off, for example +3600s.
Strings by_clock(const std::filesystem::path& file) {
  return {"env", std::string("LD_PRELOAD=") + faketime, "FAKETIME_DONT_FAKE_MONOTONIC=1",
          "FAKETIME_NO_CACHE=1", "FAKETIME_TIMESTAMP_FILE=" + file.string()};
}

void write_clock(const std::filesystem::path& file, const std::string& offset) {
  std::ofstream(file) << offset << "\n";
}

void Faults::clocks_an_hour_apart() {
  FaultRow row = begin("clock set by an hour");
  const auto file = folder_ / "clock";
  for (const std::string offset : {"+3600s", "-3600s"}) {
    write_clock(file, offset);
    processes_.at("glove").stop(seconds(5));
    const std::int64_t start = now_ns();
    processes_.insert_or_assign("glove", launch("glove", by_clock(file)));
    // The stamps that come out at the robot are by the robot's clock.
    ASSERT_TRUE(operate(15, [&] { return moved_by_ > start && moved_by_ < now_ns(); }));
    row.recoveries.push_back(1e-9 * static_cast<double>(now_ns() - start));
    const auto find_clock = [&] {
      const Answer answer = run_on("eye", {"status", "--json", "--timeout", "3"});
      return answer.output;
    };
    const std::string answer = find_clock();
    const auto sign = offset[0] == '+' ? 1.0 : -1.0;
    EXPECT_NEAR(apart(answer), sign * 3600, 1.0) << answer;
    ++row.rounds;
  }
  // Set while the process runs: nothing happens but that it is said.
  write_clock(file, "+0s");
  processes_.at("glove").stop(seconds(5));
  processes_.insert_or_assign("glove", launch("glove", by_clock(file)));
  ASSERT_GT(recovery(now_ns()), 0);
  operate(2);
  write_clock(file, "+3600s");
  const double longest = max_pause(6, [&] {
    return statuses_["glove"].message().to_string().find("clock was set") != std::string::npos;
  });
  EXPECT_NE(statuses_["glove"].message().to_string().find("clock was set"), std::string::npos)
      << "the glove says: " << statuses_["glove"].message().to_string();
  operate(2);
  EXPECT_LT(longest, promised(healed)) << "s without a frame that moved the hand";
  row.recoveries.push_back(longest);
  ++row.rounds;
  finish(row);
  renew("glove");
}

// What stands is told to who comes late: the last of each object and scene, and all reports.
void Faults::late_joiners() {
  ASSERT_TRUE(operate(60, [&] { return !reports_.empty(); })) << "no grasp is judged";
  const std::set<std::uint64_t> before = reports_;
  auto late = dds::Participant::create(
      {.name = "late", .domain = domain_, .rig = name_, .network = network_, .role = "viewer"});
  ASSERT_TRUE(late);
  auto detections = late->reader(dds::object_detection);
  auto scenes = late->reader(dds::scene_state);
  auto grasps = late->reader(dds::grasp_report);
  ASSERT_TRUE(detections && scenes && grasps);
  const std::int64_t joined = now_ns();
  bool detection = false, scene = false;
  std::set<std::uint64_t> heard;
  const bool all = operate(15, [&] {
    for (const auto& sample : detections->take()) detection |= !sample.info.gone;
    for (const auto& sample : scenes->take()) scene |= !sample.info.gone;
    for (const auto& sample : grasps->take())
      if (!sample.info.gone) heard.insert(sample.data.sequence_number());
    return detection && scene &&
           std::includes(heard.begin(), heard.end(), before.begin(), before.end());
  });
  EXPECT_TRUE(all) << "detection " << detection << ", scene " << scene << ", reports "
                   << heard.size() << " of " << before.size();
  FaultRow row;
  row.fault = "late joiner";
  row.rounds = 1;
  row.recoveries.push_back(static_cast<double>(now_ns() - joined) * 1e-9);
  EXPECT_LT(row.recoveries.back(), promised(healed));
  row.memory_before = row.memory_after = memory();
  report(row);
}

/// The glove is 50 ms away, give or take 10, each way.
class FarAway : public FaultRig {
 protected:
  void SetUp() override {
    FaultRig::SetUp();
    if (!hosts_) return;
    hosts_->add("hand", {.delay_ms = 50, .jitter_ms = 10});
    hosts_->add("eye");
    hosts_->add("robot");
    start_lab();
  }
};

TEST_F(FarAway, FiftyMillisecondsEachWay) {
  operate(rounds(4, 60));
  FaultRow row = begin("delay 50 ± 10 ms");
  row.rounds = 1;
  double p50 = 0;
  for (const auto& stage : statuses_["simulation"].latency())
    if (stage.stage().to_string() == "glove to accepted") p50 = stage.p50_us() * 1e-3;
  EXPECT_GT(p50, 40) << "ms: the delay is not there";
  EXPECT_LT(p50, promised(100)) << "ms";
  for (const auto& drop : statuses_["mapping"].drops())
    EXPECT_NE(drop.reason().to_string(), "posture stale");
  hosts_->link("hand", false);
  operate(2);
  hosts_->link("hand", true);
  expect_recovery(row, healed);
  finish(std::move(row));
}

}  // namespace
}  // namespace prehend::integration
