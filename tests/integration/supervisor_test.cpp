// Services under a supervisor that speaks systemd's protocol, whose part this test plays: when each
// says that it is ready, that it lives, and that it stops.
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <csignal>
#include <cstddef>

#include "tests/integration/rig.hpp"

namespace prehend::integration {
namespace {

class Supervised : public Rig {
 protected:
  void SetUp() override {
    path_ = (folder_ / "notify").string();
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path_.copy(address.sun_path, sizeof address.sun_path - 1);
    socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    ASSERT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  ~Supervised() override { ::close(socket_); }

  stage::Process start_supervised(Strings command, const std::string& watchdog_us,
                                  const Strings& sets = {}) {
    stage::Process::Options options;
    options.log = folder_ / (command.front() + ".log");
    options.output = folder_ / (command.front() + ".out");
    command.front() = program(command.front());
    options.command = command;
    for (const std::string& argument : lab_arguments(sets)) options.command.push_back(argument);
    options.environment = {{"NOTIFY_SOCKET", path_}, {"WATCHDOG_USEC", watchdog_us}};
    auto process = stage::Process::start(options);
    if (!process) throw std::runtime_error(process.error().message());
    return std::move(*process);
  }
  /// The next state that comes; empty: none within the limit.
  std::string next(double limit_s) const {
    pollfd ready{socket_, POLLIN, 0};
    if (::poll(&ready, 1, static_cast<int>(1000 * limit_s)) <= 0) return "";
    char text[100];
    const ssize_t size = ::recv(socket_, text, sizeof text, 0);
    return size > 0 ? std::string(text, static_cast<std::size_t>(size)) : "";
  }
  bool answers(const std::string& name) {
    return run("prehend", with_lab({"alive", name, "--timeout", "10"}), 30).exit_code == 0;
  }

 private:
  std::string path_;
  int socket_ = -1;
};

TEST_F(Supervised, EachServiceIsReadyWhenItAnswersAndSaysThatItStops) {
  const std::string shown = "lab.scene=" + scene(1);
  for (const char* name : {"glove", "recognition", "mapping", "planner", "simulation"}) {
    auto process = start_supervised({"prehend-" + std::string(name)}, "600000000", {shown});
    ASSERT_EQ(next(60), "READY=1") << name;
    EXPECT_TRUE(answers(name)) << name;
    ASSERT_EQ(next(10), "WATCHDOG=1") << name;
    process.signal(SIGTERM);
    EXPECT_EQ(next(20), "STOPPING=1") << name;
    const auto exit = process.wait(seconds(20));
    ASSERT_TRUE(exit) << name;
    EXPECT_EQ(exit->code, 0) << name;
  }
}

TEST_F(Supervised, SoDoWhoExportsWhoRecordsAndWhoServesDiscovery) {
  for (const auto& [command, sets] : std::vector<std::pair<Strings, Strings>>{
           {{"prehend", "metrics"}, {"metrics.port=0"}},
           {{"prehend-record", "--quiet", "--output", (folder_ / "all.mcap").string()}, {}},
           {{"prehend", "discovery-server", "--listen", address()}, {}}}) {
    auto process = start_supervised(command, "1000000", sets);
    ASSERT_EQ(next(60), "READY=1") << command[1];
    for (int i = 0; i < 3; ++i) ASSERT_EQ(next(20), "WATCHDOG=1") << command[1];
    process.signal(SIGTERM);
    std::string heard = next(20);
    while (heard == "WATCHDOG=1") heard = next(20);
    EXPECT_EQ(heard, "STOPPING=1") << command[1];
    const auto exit = process.wait(seconds(20));
    ASSERT_TRUE(exit) << command[1];
    EXPECT_EQ(exit->code, 0) << command[1];
  }
}

TEST_F(Supervised, OneThatCannotStartIsNeverReady) {
  auto process = start_supervised({"prehend-simulation"}, "600000000", {"simulation.hand=claw"});
  const auto exit = process.wait(seconds(30));
  ASSERT_TRUE(exit);
  EXPECT_EQ(exit->code, 3);
  EXPECT_EQ(next(0), "");
}

TEST_F(Supervised, TheWatchdogHearsAProcessUntilItIsFrozen) {
  auto process = start_supervised({"prehend-simulation"}, "1000000");
  ASSERT_EQ(next(60), "READY=1");
  for (int i = 0; i < 5; ++i) ASSERT_EQ(next(20), "WATCHDOG=1");
  process.signal(SIGSTOP);
  // What it had said before.
  while (!next(0.2).empty()) {
  }
  EXPECT_EQ(next(2.5), "") << "more than twice the time after which it counts as hung";
  process.signal(SIGCONT);
  EXPECT_EQ(next(20), "WATCHDOG=1");
  process.signal(SIGTERM);
  for (std::string heard = next(20); heard != "STOPPING=1"; heard = next(20))
    ASSERT_EQ(heard, "WATCHDOG=1");
}

}  // namespace
}  // namespace prehend::integration
