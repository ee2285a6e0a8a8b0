// A server among clients that mean it well and others: who is slow, silent, too long or
// too many takes nothing from who only wants the page.
#include "common/web/server.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <list>
#include <mutex>
#include <thread>

#include "tests/support/metrics/client.hpp"

namespace prehend::web {
namespace {

using tests::Client;

const std::string good = "GET / HTTP/1.1\r\nHost: lab\r\n\r\n";

class Served : public testing::Test, public Site {
 protected:
  void SetUp() override { begin({}); }
  ~Served() override { end(); }
  void begin(Server::Options options) {
    end();
    auto made = Server::listen(options, *this);
    ASSERT_TRUE(made) << made.error().message();
    server_ = std::move(*made);
    stop_ = false;
    thread_ = std::thread([this] {
      while (!stop_) {
        server_->run_for(std::chrono::milliseconds(20));
        clients_ = server_->clients();
      }
    });
  }
  void end() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  std::variant<Answer, Upgrade> answer(const Request& request) override;

  std::string ask(const std::string& request) const {
    const Client client(server_->port());
    client.say(request);
    return client.hear();
  }

  std::string page() const {
    const std::scoped_lock lock(mutex_);
    return page_;
  }
  void set_page(std::string text) {
    const std::scoped_lock lock(mutex_);
    page_ = std::move(text);
  }

  mutable std::mutex mutex_;  // guards the page
  std::string page_ = "prehend_up 1\n";
  std::atomic<bool> stop_ = true;
  std::atomic<std::size_t> clients_ = 0;
  std::atomic<int> asked_ = 0;  // for anything
  std::atomic<int> open_ = 0;   // WebSockets
  std::unique_ptr<Server> server_;
  std::thread thread_;
};

TEST_F(Served, AnswersOneAfterTheOther) {
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(ask(good).ends_with("\r\n\r\n" + page()));
}

TEST_F(Served, APageThatDoesNotFitIntoTheSocketComesWhole) {
  set_page(std::string(8'000'000, 'x') + "\n");
  const std::string said = ask(good);
  EXPECT_TRUE(said.ends_with("x\n"));
  EXPECT_GT(said.size(), 8'000'000u);
}

TEST_F(Served, ARequestThatIsTooLongIsRefusedAndTheAnswerArrives) {
  EXPECT_TRUE(ask("GET / HTTP/1.1\r\nX: " + std::string(60'000, 'x')).starts_with("HTTP/1.1 431 "));
}

TEST_F(Served, ARequestInPiecesIsWaitedFor) {
  const Client client(server_->port());
  for (const char c : good) client.say({&c, 1});
  EXPECT_TRUE(client.hear().ends_with(page()));
}

TEST_F(Served, WhoLeavesHalfwayIsForgotten) {
  {
    const Client client(server_->port());
    client.say("GET /");
    client.end();
    EXPECT_EQ(client.hear(), "");
  }
  EXPECT_TRUE(ask(good).ends_with(page()));
}

TEST_F(Served, TheSilentAndTheSlowAreSentAway) {
  begin({.patience = std::chrono::milliseconds(200)});
  const Client silent(server_->port()), slow(server_->port());
  slow.say("GET / HTTP/1.1\r\n");
  EXPECT_EQ(silent.hear(), "");
  EXPECT_EQ(slow.hear(), "");
  set_page(std::string(20'000'000, 'x'));
  std::list<Client>
      deaf;  // ask, and do not take the answer; on a busy machine the first may be late
  while (asked_ == 0) {
    deaf.emplace_back(server_->port());
    deaf.back().say(good);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  set_page("prehend_up 1\n");
  // On a machine that is busy even this one may be too slow, once.
  while (!ask(good).ends_with(page())) {
  }
  while (clients_ > 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

TEST_F(Served, ManySilentOnesTakeNoPlace) {
  begin({.max_clients = 8, .patience = std::chrono::seconds(600)});
  std::list<Client> crowd;
  for (int i = 0; i < 200; ++i) {
    crowd.emplace_back(server_->port());
    if (i % 2) crowd.back().say("GET ");
    EXPECT_LE(clients_, 8u);
  }
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(ask(good).ends_with(page())) << i;
  EXPECT_LE(clients_, 8u);
}

/// Greets, and says when it is there and when it is gone.
class Greeting final : public Channel {
 public:
  explicit Greeting(std::atomic<int>& open) : open_(open) { ++open_; }
  ~Greeting() override { --open_; }
  void hear(std::string_view, bool) override {}
  std::optional<Frame> next() override {
    if (std::exchange(greeted_, true)) return std::nullopt;
    return Frame{false, "he", std::make_shared<const std::string>("llo")};
  }
  bool overflowed() const override { return false; }

 private:
  std::atomic<int>& open_;
  bool greeted_ = false;
};

std::variant<Answer, Upgrade> Served::answer(const Request& request) {
  ++asked_;
  if (request.upgrade) return Upgrade{"hello.v1", std::make_unique<Greeting>(open_)};
  return Answer{200, "text/plain", page()};
}

TEST_F(Served, AnOpenWebSocketKeepsItsPlace) {
  begin({.max_clients = 1, .patience = std::chrono::milliseconds(200)});
  const Client viewer(server_->port());
  viewer.say(
      "GET / HTTP/1.1\r\nHost: lab\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
      "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
  while (open_ == 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  std::this_thread::sleep_for(std::chrono::milliseconds(400));  // beyond what a request has
  EXPECT_EQ(ask(good), "") << "there is one place";
  EXPECT_EQ(open_, 1);
  viewer.end();
  const std::string said = viewer.hear();
  EXPECT_TRUE(said.starts_with("HTTP/1.1 101 ")) << said;
  EXPECT_THAT(said, testing::HasSubstr("Sec-WebSocket-Protocol: hello.v1\r\n"));
  EXPECT_TRUE(said.ends_with("\r\n\r\n\x81\x05hello")) << said;
  while (open_ > 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_TRUE(ask(good).ends_with(page()));
}

class Silent final : public Site {
  std::variant<Answer, Upgrade> answer(const Request&) override { return Answer{}; }
};

TEST(Server, SaysWhereItCannotListen) {
  Silent site;
  const auto first = Server::listen({}, site);
  ASSERT_TRUE(first);
  const auto second = Server::listen({.port = (*first)->port()}, site);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().where, testing::HasSubstr(std::to_string((*first)->port())));
  EXPECT_FALSE(Server::listen({.address = "lab.example"}, site));
  EXPECT_FALSE(Server::listen({.address = "192.0.2.1"}, site)) << "not of this host";
}

}  // namespace
}  // namespace prehend::web
