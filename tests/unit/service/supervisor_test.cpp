// What a supervisor is told, by the protocol of systemd. A datagram socket plays its part.
#include "common/service/supervisor.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>

namespace prehend::service {
namespace {

const std::string notify_name = "@prehend-supervisor-test/" + std::to_string(::getpid());
constexpr Duration period = std::chrono::seconds(10);
const Time begin = from_ns(1'700'000'000'000'000'000);

class Heard {
 public:
  Heard() : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    notify_name.copy(address.sun_path + 1, notify_name.size() - 1, 1);
    const auto length =
        static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + notify_name.size());
    EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&address), length), 0);
  }
  ~Heard() { ::close(socket_); }
  /// The next datagram; empty: there is none.
  std::string next() const {
    char text[100];
    const ssize_t size = ::recv(socket_, text, sizeof text, 0);
    return size > 0 ? std::string(text, static_cast<std::size_t>(size)) : "";
  }

 private:
  int socket_;
};

TEST(Supervisor, HearsThatTheLoopRunsAsLongAsItDoes) {
  const Heard heard;
  Supervisor supervisor(Supervision{notify_name, period});
  EXPECT_EQ(heard.next(), "") << "not before the loop runs";
  EXPECT_EQ(supervisor.beat(begin), begin + period / 2);
  EXPECT_EQ(heard.next(), "READY=1");
  EXPECT_EQ(heard.next(), "WATCHDOG=1");
  EXPECT_EQ(supervisor.beat(begin + period / 4), begin + period / 2);
  EXPECT_EQ(heard.next(), "") << "not more often than is asked for";
  supervisor.beat(begin + period / 2);
  EXPECT_EQ(heard.next(), "WATCHDOG=1");
  EXPECT_EQ(heard.next(), "") << "ready once";
  supervisor.stopping();
  EXPECT_EQ(heard.next(), "STOPPING=1");
}

TEST(Supervisor, WithoutAWatchdogItHearsOnlyBeginningAndEnd) {
  const Heard heard;
  Supervisor supervisor(Supervision{notify_name, {}});
  EXPECT_EQ(supervisor.beat(begin), Time::max());
  EXPECT_EQ(heard.next(), "READY=1");
  supervisor.beat(begin + period);
  EXPECT_EQ(heard.next(), "");
}

TEST(Supervisor, OneThatCameLateIsToldAllTheSame) {
  Supervisor supervisor(Supervision{notify_name, period});
  supervisor.beat(begin);
  const Heard heard;
  supervisor.beat(begin + period);
  EXPECT_EQ(heard.next(), "READY=1");
  EXPECT_EQ(heard.next(), "WATCHDOG=1");
}

class FromEnvironment : public testing::Test {
 protected:
  ~FromEnvironment() override {
    for (const char* variable : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"})
      ::unsetenv(variable);
  }
};

TEST_F(FromEnvironment, NobodyAsks) {
  ::setenv("WATCHDOG_USEC", "1000000", 1);
  const auto found = Supervision::from_environment();
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->socket.empty());
  EXPECT_FALSE(found->watchdog);
  EXPECT_EQ(Supervisor().beat(begin), Time::max());
}

TEST_F(FromEnvironment, TheWatchdogOfAnotherProcessIsNotOurs) {
  ::setenv("NOTIFY_SOCKET", "/run/systemd/notify", 1);
  ::setenv("WATCHDOG_USEC", "1500000", 1);
  EXPECT_EQ(Supervision::from_environment()->watchdog, std::chrono::milliseconds(1500));
  ::setenv("WATCHDOG_PID", std::to_string(::getpid()).c_str(), 1);
  EXPECT_EQ(Supervision::from_environment()->watchdog, std::chrono::milliseconds(1500));
  ::setenv("WATCHDOG_PID", std::to_string(::getppid()).c_str(), 1);
  EXPECT_FALSE(Supervision::from_environment()->watchdog);
}

TEST_F(FromEnvironment, WhatCannotBeMeantIsAnErrorAndStopsNothing) {
  for (const std::string& socket : {std::string("run/notify"), std::string("@"), std::string("/"),
                                    "/" + std::string(200, 'x')}) {
    ::setenv("NOTIFY_SOCKET", socket.c_str(), 1);
    EXPECT_FALSE(Supervision::from_environment()) << socket;
    EXPECT_EQ(Supervisor().beat(begin), Time::max());
  }
  ::setenv("NOTIFY_SOCKET", notify_name.c_str(), 1);
  for (const char* us : {"0", "-5", "1s", "99999999999999999999"}) {
    ::setenv("WATCHDOG_USEC", us, 1);
    EXPECT_FALSE(Supervision::from_environment()) << us;
  }
}

}  // namespace
}  // namespace prehend::service
