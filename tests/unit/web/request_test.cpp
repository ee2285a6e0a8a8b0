// Requests as they come over the wire: what reaches the site, what is refused before, and when more
// is waited for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

#include "common/web/server.hpp"
#include "tests/support/metrics/client.hpp"

namespace prehend::web {
namespace {

/// Keeps what it was asked, and says so.
class Echo final : public Site {
 public:
  std::variant<Answer, Upgrade> answer(const Request& request) override {
    asked = request;
    return Answer{200, "text/plain", request.method + " " + request.target, {{"X-Own", "1"}}};
  }
  std::optional<Request> asked;
};

class Requests : public testing::Test {
 protected:
  Requests() : server_(std::move(Server::listen({}, site_).value())) {}
  /// All that is answered to these bytes, behind which nothing comes.
  std::string ask(const std::string& request) {
    site_.asked.reset();
    const tests::Client client(server_->port());
    client.say(request);
    client.end();
    auto said = std::async(std::launch::async, [&] { return client.hear(); });
    while (said.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
      server_->run_for(std::chrono::milliseconds(1));
    return said.get();
  }
  /// 0: there is no answer.
  int status(const std::string& request) {
    const std::string said = ask(request);
    return said.starts_with("HTTP/1.1 ") ? std::stoi(said.substr(9, 3)) : 0;
  }

  Echo site_;
  std::unique_ptr<Server> server_;
};

TEST_F(Requests, ComeToTheSiteWithWhatTheySay) {
  EXPECT_EQ(status("POST /a?b=c HTTP/1.1\r\nhost: lab\r\nCookie: a=1\r\nX-Tab: a\tb\r\n"
                   "COOKIE: b=2\r\nContent-Length: 4\r\n\r\nbody"),
            200);
  ASSERT_TRUE(site_.asked);
  EXPECT_EQ(site_.asked->method, "POST");
  EXPECT_EQ(site_.asked->target, "/a?b=c");
  EXPECT_EQ(site_.asked->body, "body");
  EXPECT_EQ(site_.asked->field("Host"), "lab");
  EXPECT_EQ(site_.asked->field("cookie"), "a=1,b=2");
  EXPECT_EQ(site_.asked->field("X-Tab"), "a\tb");
  EXPECT_EQ(site_.asked->field("X-None"), "");
  EXPECT_FALSE(site_.asked->upgrade);
  for (const char* request :
       {"GET / HTTP/1.0\r\n\r\n", "get http://lab/ HTTP/1.1\r\nHost: lab\r\n\r\n",
        "BREW * HTTP/1.1\r\nHost:\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: a\r\n\r\nGET /next HTTP/1.1\r\n"}) {
    EXPECT_EQ(status(request), 200) << request;
  }
  EXPECT_EQ(site_.asked->target, "/") << "one request a connection";
}

TEST_F(Requests, AreAnsweredWithLengthAndNoBodyWhereOnlyTheHeadWasAskedFor) {
  const std::string whole = ask("GET / HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_THAT(whole, testing::StartsWith("HTTP/1.1 200 OK\r\n"));
  for (const char* field : {"Content-Type: text/plain\r\n", "Content-Length: 5\r\n",
                            "Cache-Control: no-store\r\n", "X-Own: 1\r\n", "Connection: close\r\n"})
    EXPECT_THAT(whole, testing::HasSubstr(field));
  EXPECT_THAT(whole, testing::EndsWith("\r\n\r\nGET /"));
  const std::string head = ask("HEAD / HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_THAT(head, testing::HasSubstr("Content-Length: 6\r\n"));
  EXPECT_THAT(head, testing::EndsWith("\r\n\r\n"));
}

TEST_F(Requests, AreWaitedForUntilTheirEnd) {
  const std::string request = "GET / HTTP/1.1\r\nHost: lab\r\nAccept: text/plain\r\n\r\n";
  for (std::size_t size = 0; size < request.size(); ++size)
    EXPECT_EQ(status(request.substr(0, size)), 0) << request.substr(0, size);
  EXPECT_EQ(status(request), 200);
  EXPECT_EQ(status("POST / HTTP/1.1\r\nHost: a\r\nContent-Length: 5\r\n\r\nbody"), 0);
}

TEST_F(Requests, ThatAreNoneAreRefused) {
  for (const char* request :
       {"GET\r\n", "GET /\r\n", "GET  / HTTP/1.1\r\n", "G\x01T / HTTP/1.1\r\n", "nonsense\r\n",
        "\x16\x03\x01\r\n", "GET /\x01 HTTP/1.1\r\n"})
    EXPECT_EQ(status(request), 400) << request;
  EXPECT_EQ(status("GET / HTTP/2.0\r\n"), 505);
  for (const char* fields : {"", "Host: a\r\nHost: b\r\n", "Host a\r\n", "Host : a\r\n",
                             ": b\r\nHost: a\r\n", "Host: a\nB: c\r\n", "Host: a\x7f\r\n"})
    EXPECT_EQ(status("GET / HTTP/1.1\r\n" + std::string(fields) + "\r\n"), 400) << fields;
  EXPECT_FALSE(site_.asked);
}

TEST_F(Requests, ThatDoNotEndAreTooLarge) {
  const std::string begin = "GET / HTTP/1.1\r\nHost: a\r\n";
  EXPECT_EQ(status(begin + "X: " + std::string(7000, 'x') + "\r\n\r\n"), 200);
  EXPECT_EQ(status(std::string(60'000, 'G')), 431);
  EXPECT_EQ(status(begin + "X: " + std::string(60'000, 'x')), 431);
  EXPECT_EQ(status("GET /" + std::string(9000, 'x') + " HTTP/1.1\r\n"), 431);
  EXPECT_EQ(status(begin + "Content-Length: 2048\r\n\r\n" + std::string(2048, 'x')), 200);
  EXPECT_EQ(status(begin + "Content-Length: 2049\r\n\r\n"), 413);
  EXPECT_EQ(status(begin + "Transfer-Encoding: chunked\r\n\r\n1000\r\n" + std::string(4096, 'x')),
            413);
}

}  // namespace
}  // namespace prehend::web
