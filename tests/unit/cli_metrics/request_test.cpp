// Requests for a page: what is answered, what is refused, and when more must come.
#include "services/cli/tools/metrics/http/request.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace prehend::cli::http {
namespace {

int status(const std::string& request) {
  return judge(request, "/metrics").status;
}

TEST(Request, ThePageIsServed) {
  for (const char* request :
       {"GET /metrics HTTP/1.1\r\nHost: lab:9478\r\n\r\n", "GET /metrics HTTP/1.0\r\n\r\n",
        "GET /metrics?name=x HTTP/1.1\r\nhost:\r\n\r\n",
        "GET http://lab:9478/metrics HTTP/1.1\r\nHost: lab\r\nAccept: */*\r\nX-Tab: a\tb\r\n\r\n",
        "GET /metrics HTTP/1.1\r\nHost: a\r\n\r\nGET /next HTTP/1.1\r\n"}) {
    EXPECT_EQ(status(request), 200) << request;
    EXPECT_TRUE(judge(request, "/metrics").body);
  }
  const Verdict head = judge("HEAD /metrics HTTP/1.1\r\nHost: a\r\n\r\n", "/metrics");
  EXPECT_EQ(head.status, 200);
  EXPECT_FALSE(head.body);
}

TEST(Request, EveryBeginningOfAGoodOneWaitsForMore) {
  const std::string request = "GET /metrics HTTP/1.1\r\nHost: lab\r\nAccept: text/plain\r\n\r\n";
  for (std::size_t size = 0; size < request.size(); ++size)
    EXPECT_EQ(status(request.substr(0, size)), 0) << request.substr(0, size);
  EXPECT_EQ(status(request), 200);
}

TEST(Request, OtherPathsAndMethods) {
  EXPECT_EQ(status("GET / HTTP/1.1\r\nHost: a\r\n\r\n"), 404);
  EXPECT_EQ(status("GET /metrics/ HTTP/1.1\r\nHost: a\r\n\r\n"), 404);
  EXPECT_EQ(status("GET /METRICS HTTP/1.1\r\nHost: a\r\n\r\n"), 404);
  EXPECT_EQ(status("GET http://lab HTTP/1.1\r\nHost: a\r\n\r\n"), 404);
  EXPECT_FALSE(judge("HEAD /other HTTP/1.1\r\nHost: a\r\n\r\n", "/metrics").body);
  for (const std::string method : {"POST", "PUT", "DELETE", "OPTIONS", "TRACE", "get", "BREW"})
    EXPECT_EQ(status(method + " /metrics HTTP/1.1\r\nHost: a\r\n\r\n"), 405) << method;
}

TEST(Request, WhatIsNoneIsRefusedAsSoonAsThatIsSeen) {
  for (const char* request : {"\r\n", "GET\r\n", "GET /metrics\r\n", "GET  /metrics HTTP/1.1\r\n",
                              "GET /metrics HTTP/1.1 \r\n", "GET /metrics HTTP/11\r\n",
                              "GET metrics HTTP/1.1\r\n", "G\x01T /metrics HTTP/1.1\r\n",
                              "GET /met\x80rics HTTP/1.1\r\n", "GET /metrics http/1.1\r\n"})
    EXPECT_EQ(status(request), 400) << request;
  EXPECT_EQ(status("GET /metrics HTTP/2.0\r\n"), 505);
  for (const char* fields :
       {"", "Host: a\r\nHost: b\r\n", "Host a\r\n", "Host: a\r\n folded: b\r\n", "Host : a\r\n",
        ": b\r\nHost: a\r\n", "Host: a\nB: c\r\n", "Host: a\x7f\r\n"})
    EXPECT_EQ(status("GET /metrics HTTP/1.1\r\n" + std::string(fields) + "\r\n"), 400) << fields;
}

TEST(Request, OneThatDoesNotEndIsTooLarge) {
  EXPECT_EQ(status(std::string(max_request, 'G')), 0);
  EXPECT_EQ(status(std::string(max_request + 1, 'G')), 431);
  const std::string begin = "GET /metrics HTTP/1.1\r\nHost: a\r\nX: ";
  EXPECT_EQ(status(begin + std::string(max_request, 'x')), 431);
  std::string many = "GET /metrics HTTP/1.0\r\n";
  for (int i = 0; i < 101; ++i) many += "A: b\r\n";
  EXPECT_EQ(status(many + "\r\n"), 431);
}

TEST(Response, HasLengthTypeAndNoBodyWhereOnlyTheHeadWasAskedFor) {
  const std::string page = "prehend_up 1\n";
  const std::string whole = response({200, true}, page), head = response({200, false}, page);
  EXPECT_TRUE(whole.starts_with("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(whole, testing::HasSubstr("Content-Type: text/plain; version=0.0.4"));
  EXPECT_THAT(whole, testing::HasSubstr("Content-Length: 13\r\n"));
  EXPECT_EQ(whole, head + page);
  EXPECT_TRUE(head.ends_with("\r\n\r\n"));
  EXPECT_THAT(response({405, true}, page), testing::HasSubstr("Allow: GET, HEAD\r\n"));
  for (const int code : {400, 404, 405, 431, 505}) {
    const std::string refusal = response({code, true}, page);
    EXPECT_TRUE(refusal.starts_with("HTTP/1.1 " + std::to_string(code) + " "));
    EXPECT_EQ(refusal.find(page), std::string::npos);
  }
}

}  // namespace
}  // namespace prehend::cli::http
