// Children of this program: how they end, and that none is ever left behind. Limits of seconds only
// bound the waiting; a passing test waits for events.
#include "common/stage/process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "common/stage/temporary_folder.hpp"

namespace prehend::stage {
namespace {

Process::Options shell(const std::string& script, const std::filesystem::path& log = {}) {
  Process::Options options;
  options.command = {"/bin/sh", "-c", script};
  options.log = log;
  return options;
}

/// Nothing of that number runs any more; one that nobody has reaped yet does not run.
bool is_dead(pid_t pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  if (!std::getline(stat, text)) return true;
  return text.substr(text.rfind(')') + 2, 1) == "Z";
}

bool eventually(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

class ProcessTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::TempDir() + "process-XXXXXX";
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

TEST_F(ProcessTest, TellsHowItEnded) {
  auto process = Process::start(shell("exit 7"));
  ASSERT_TRUE(process) << process.error().message();
  const auto exit = process->wait(seconds(10));
  ASSERT_TRUE(exit);
  EXPECT_EQ(exit->code, 7);
  EXPECT_EQ(exit->signal, 0);
  EXPECT_EQ(process->exit()->code, 7) << "asking again gives the same answer";
}

// Guards that a service which falls in a live test is seen as a crash, whatever else failed there.
TEST_F(ProcessTest, ACrashStandsInItsLog) {
  const auto log = folder_ / "log";
  auto process = Process::start(shell("echo begun; kill -SEGV $$", log));
  ASSERT_TRUE(process) << process.error().message();
  ASSERT_TRUE(process->wait(seconds(10)));
  EXPECT_THAT(last_lines(log, 2), testing::MatchesRegex("begun\ncrashed: signal 11 .*"));
}

TEST_F(ProcessTest, TellsTheSignalThatKilledIt) {
  auto process = Process::start(shell("kill -9 $$"));
  ASSERT_TRUE(process);
  const auto exit = process->wait(seconds(10));
  ASSERT_TRUE(exit);
  EXPECT_EQ(exit->signal, SIGKILL);
  EXPECT_EQ(exit->code, 128 + SIGKILL);
}

TEST_F(ProcessTest, AMissingProgramIsAnError) {
  Process::Options options;
  options.command = {(folder_ / "nothing").string()};
  const auto process = Process::start(options);
  ASSERT_FALSE(process);
  EXPECT_NE(process.error().message().find("nothing"), std::string::npos);
  EXPECT_NE(process.error().message().find("No such file"), std::string::npos);
}

TEST_F(ProcessTest, NoProgramAndOneThatDoesNotAnswerAreErrors) {
  EXPECT_EQ(Process::start({}).error().message(), "starting a process: no program is named");
  const auto silent = printed_by("/bin/sleep", {"60"}, std::chrono::milliseconds(20));
  EXPECT_EQ(silent.error().message(), "/bin/sleep: does not answer");
}

TEST(TemporaryFolder, SaysWhereItCannotBeMade) {
  const char* before = std::getenv("TMPDIR");
  const std::string kept = before ? before : "";
  ::setenv("TMPDIR", "/proc", 1);  // where nobody may
  const auto made = TemporaryFolder::create(false);
  before ? ::setenv("TMPDIR", kept.c_str(), 1) : ::unsetenv("TMPDIR");
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().message(), "/proc: cannot make a folder (set TMPDIR)");
}

TEST_F(ProcessTest, LogsBothStreamsOrTheOutputApart) {
  auto both = Process::start(shell("echo one; echo two >&2; echo three", folder_ / "both"));
  ASSERT_TRUE(both && both->wait(seconds(10)));
  EXPECT_EQ(last_lines(folder_ / "both", 2), "two\nthree");
  Process::Options options = shell("echo out; echo err >&2", folder_ / "log");
  options.output = folder_ / "output";
  auto apart = Process::start(options);
  ASSERT_TRUE(apart && apart->wait(seconds(10)));
  EXPECT_EQ(last_lines(folder_ / "output", 9), "out");
  EXPECT_EQ(last_lines(folder_ / "log", 9), "err");
  EXPECT_EQ(last_lines(folder_ / "none", 9), "");
}

TEST_F(ProcessTest, AddsToTheEnvironment) {
  Process::Options options = shell("echo $ADDED $HOME", folder_ / "log");
  options.environment = {{"ADDED", "yes"}, {"HOME", "replaced"}};
  auto process = Process::start(options);
  ASSERT_TRUE(process && process->wait(seconds(10)));
  EXPECT_EQ(last_lines(folder_ / "log", 1), "yes replaced");
}

TEST_F(ProcessTest, StopAsksFirst) {
  auto process = Process::start(
      shell("trap 'exit 5' TERM; echo ready; while :; do sleep 0.01; done", folder_ / "log"));
  ASSERT_TRUE(process);
  ASSERT_TRUE(eventually([&] { return last_lines(folder_ / "log", 1) == "ready"; }));
  EXPECT_FALSE(process->exit());
  const auto exit = process->stop(seconds(10));
  EXPECT_EQ(exit.code, 5);
}

TEST_F(ProcessTest, StopKillsWhatDoesNotListen) {
  auto process = Process::start(
      shell("trap '' TERM; echo ready; while :; do sleep 0.01; done", folder_ / "log"));
  ASSERT_TRUE(process);
  ASSERT_TRUE(eventually([&] { return last_lines(folder_ / "log", 1) == "ready"; }));
  const auto exit = process->stop(seconds(0.2));
  EXPECT_EQ(exit.signal, SIGKILL);
  EXPECT_TRUE(is_dead(process->pid()));
}

TEST_F(ProcessTest, TakesItsOwnChildrenAlong) {
  pid_t grandchild = 0;
  {
    auto process = Process::start(shell("sleep 1000 & echo $!; wait", folder_ / "log"));
    ASSERT_TRUE(process);
    ASSERT_TRUE(eventually([&] { return !last_lines(folder_ / "log", 1).empty(); }));
    grandchild = std::stoi(last_lines(folder_ / "log", 1));
    EXPECT_FALSE(is_dead(grandchild));
  }
  EXPECT_TRUE(eventually([&] { return is_dead(grandchild); }));
}

TEST_F(ProcessTest, DiesWithItsParent) {
  int pipe[2];
  ASSERT_EQ(::pipe(pipe), 0);
  const pid_t parent = ::fork();
  ASSERT_GE(parent, 0);
  if (parent == 0) {
    auto process = Process::start(shell("exec sleep 1000"));
    const pid_t pid = process ? process->pid() : -1;
    if (::write(pipe[1], &pid, sizeof(pid)) < 0) ::_exit(1);
    ::pause();
    ::_exit(0);
  }
  pid_t child = -1;
  ASSERT_EQ(::read(pipe[0], &child, sizeof(child)), static_cast<ssize_t>(sizeof(child)));
  ASSERT_GT(child, 0);
  EXPECT_FALSE(is_dead(child));
  ::kill(parent, SIGKILL);  // no destructor runs
  ::waitpid(parent, nullptr, 0);
  EXPECT_TRUE(eventually([&] { return is_dead(child); }));
  ::close(pipe[0]);
  ::close(pipe[1]);
}

}  // namespace
}  // namespace prehend::stage
