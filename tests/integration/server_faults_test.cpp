// The discovery server is cut off from its lab, on a host of its own: who knew each other goes on
// as if nothing were, and whoever starts meanwhile is found soon after the server's return.
#include <csignal>

#include "tests/integration/fault_rig.hpp"

namespace prehend::integration {
namespace {

constexpr double found = 2.0;    // s, after the server's return
constexpr double goes_on = 0.5;  // s, more than before, between frames that move the hand

class ServerFaults : public FaultRig {
 protected:
  // «post» is the second host.
  ServerFaults() : FaultRig({.profile = "server", .servers = {"10.77.0.2:11811"}}) {}
  void SetUp() override {
    FaultRig::SetUp();
    if (!hosts_) return;
    for (const char* host : {"post", "hand", "eye", "robot"}) hosts_->add(host);
    Strings serve{program("prehend"), "discovery-server", "--listen", "0.0.0.0:11811"};
    for (const std::string& argument : lab_arguments()) serve.push_back(argument);
    auto made = stage::Process::start(
        {.command = hosts_->on("post", serve), .log = folder_ / "server.log"});
    ASSERT_TRUE(made);
    server_.emplace(std::move(*made));
    start_lab();
  }
  std::optional<stage::Process> server_;
};

TEST_F(ServerFaults, CutOffAndBack) {
  FaultRow row = begin("discovery server cut off");
  for (row.rounds = 0; row.rounds < rounds(1, 10); ++row.rounds) {
    hosts_->link("post", false);
    EXPECT_LT(max_pause(rounds(3, 10)), goes_on + 2 * undisturbed_)
        << "s, links that are there must go on";
    processes_.at("glove").signal(SIGKILL);
    ASSERT_TRUE(processes_.at("glove").wait(seconds(5)));
    const std::int64_t start = now_ns();
    processes_.insert_or_assign("glove", launch("glove"));
    EXPECT_FALSE(operate(1, [&] { return moved_by_ > start; })) << "found without the server";
    hosts_->link("post", true);
    expect_recovery(row, found);
  }
  finish(std::move(row));
}

}  // namespace
}  // namespace prehend::integration
