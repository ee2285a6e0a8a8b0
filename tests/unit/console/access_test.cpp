// Who may look and who may order, told from the head of a request alone: every header here is one
// that a browser sends whatever the page in it wants, or one that it cannot send.
#include "services/console/core/access.hpp"

#include <gtest/gtest.h>

#include "services/console/core/orders.hpp"

namespace prehend::console {
namespace {

Policy local() {
  return {.hosts = names_of("127.0.0.1", 8765), .order_token = "0123456789abcdef"};
}

Asked get(const std::string& target) {
  return {.method = "GET", .target = target, .host = "localhost:8765"};
}

Asked socket(const std::string& protocols, const std::string& origin = "") {
  Asked asked = get("/");
  asked.origin = origin;
  asked.upgrade = true;
  asked.protocols = protocols;
  return asked;
}

Asked order() {
  return {.method = "POST",
          .target = "/order",
          .host = "localhost:8765",
          .origin = "http://localhost:8765",
          .token = "0123456789abcdef"};
}

TEST(Access, ThePageIsForWhoAsksByItsName) {
  EXPECT_EQ(judge(get("/"), local()).route, Route::page);
  EXPECT_EQ(judge(get("/page.js"), local()).what, "/page.js");
  for (const char* host :
       {"evil.example:8765", "localhost", "localhost:80", "", "127.0.0.1:8766"}) {
    Asked asked = get("/");
    asked.host = host;
    EXPECT_EQ(judge(asked, local()).status, 421) << host;
  }
  for (const char* host : {"127.0.0.1:8765", "[::1]:8765", "LocalHost:8765"}) {
    Asked asked = get("/");
    asked.host = host;
    EXPECT_EQ(judge(asked, local()).route, Route::page) << host;
  }
  EXPECT_EQ(judge(get("/etc/passwd"), local()).status, 404);
  EXPECT_EQ(judge(get("/../page.js"), local()).status, 404);
  Asked posted = get("/");
  posted.method = "POST";
  EXPECT_EQ(judge(posted, local()).status, 405);
}

TEST(Access, OneOfferedProtocolIsAnswered) {
  EXPECT_EQ(judge(socket("foxglove.websocket.v1"), local()).what, "foxglove.websocket.v1");
  EXPECT_EQ(judge(socket("foxglove.sdk.v1"), local()).what, "foxglove.sdk.v1");
  EXPECT_EQ(judge(socket("foxglove.websocket.v1, foxglove.sdk.v1"), local()).what,
            "foxglove.sdk.v1");
  for (const char* offered : {"", "chat", "foxglove.sdk.v2", "foxglove.sdk.v1x", ", ,"})
    EXPECT_EQ(judge(socket(offered), local()).status, 400) << offered;
}

TEST(Access, OtherSitesLookOnlyWhereListed) {
  const std::string known = "https://app.example.org";
  EXPECT_EQ(judge(socket("foxglove.sdk.v1", "http://localhost:8765"), local()).route,
            Route::socket);
  EXPECT_EQ(judge(socket("foxglove.sdk.v1", known), local()).status, 403);
  EXPECT_EQ(judge(socket("foxglove.sdk.v1", "null"), local()).status, 403);
  // Another port is another site, and so is another name of this machine.
  EXPECT_EQ(judge(socket("foxglove.sdk.v1", "http://localhost:8080"), local()).status, 403);
  EXPECT_EQ(judge(socket("foxglove.sdk.v1", "http://127.0.0.1:8765"), local()).status, 403);
  Policy open = local();
  open.viewers = {known};
  EXPECT_EQ(judge(socket("foxglove.sdk.v1", known), open).route, Route::socket);
  Asked asked = order();
  asked.origin = known;
  EXPECT_EQ(judge(asked, open).status, 403) << "who may look may not order";
}

TEST(Access, OrdersComeFromThePageAlone) {
  EXPECT_EQ(judge(order(), local()).route, Route::order);
  Asked asked = order();
  asked.origin = "";
  EXPECT_EQ(judge(asked, local()).status, 403);
  asked.origin = "https://localhost:8765";
  EXPECT_EQ(judge(asked, local()).status, 403) << "not served by https";
  asked = order();
  for (const char* token : {"", "0123456789abcdeF", "0123456789abcde", "0123456789abcdef0"}) {
    asked.token = token;
    EXPECT_EQ(judge(asked, local()).status, 403) << token;
  }
  asked = order();
  asked.method = "GET";
  EXPECT_EQ(judge(asked, local()).status, 405);
  Policy none = local();
  none.order_token.clear();
  asked = order();
  asked.token.clear();
  EXPECT_EQ(judge(asked, none).status, 403) << "no token is no token, not an empty one";
}

// What leads a robot's hand is let in as orders are.
TEST(Access, AHandAndConsentComeFromThePageAlone) {
  for (const auto& [target, route] :
       {std::pair{"/hand", Route::hand}, {"/consent", Route::consent}}) {
    Asked asked = order();
    asked.target = target;
    EXPECT_EQ(judge(asked, local()).route, route);
    asked.token = "another";
    EXPECT_EQ(judge(asked, local()).status, 403);
    asked = order();
    asked.target = target;
    asked.origin = "https://evil.example";
    EXPECT_EQ(judge(asked, local()).status, 403);
    EXPECT_EQ(judge(get(target), local()).status, 405);
  }
  EXPECT_EQ(judge(get("/hands/hands.js"), local()).route, Route::tracking);
  EXPECT_EQ(judge(get("/hands/hands.js"), local()).what, "hands.js");
}

TEST(Access, AwayFromThisMachineNobodyLooksWithoutTheToken) {
  Policy policy = local();
  policy.access_token = "a-token-of-the-lab";
  EXPECT_EQ(judge(get("/"), policy).status, 401);
  EXPECT_EQ(judge(socket("foxglove.sdk.v1"), policy).status, 401);
  EXPECT_EQ(judge(order(), policy).status, 401);
  const Verdict first = judge(get("/?token=a-token-of-the-lab"), policy);
  EXPECT_EQ(first.route, Route::page);
  EXPECT_TRUE(first.set_cookie);
  EXPECT_EQ(judge(get("/?token=another"), policy).status, 401);
  EXPECT_EQ(judge(get("/?x=a-token-of-the-lab"), policy).status, 401);
  Asked asked = socket("foxglove.sdk.v1");
  asked.cookie = "theme=dark; prehend=a-token-of-the-lab";
  EXPECT_EQ(judge(asked, policy).route, Route::socket);
  asked.cookie = "notprehend=a-token-of-the-lab";
  EXPECT_EQ(judge(asked, policy).status, 401);
}

TEST(Access, OnlyLoopbackIsThisMachine) {
  for (const char* address : {"127.0.0.1", "127.1.2.3", "::1", "localhost"})
    EXPECT_TRUE(is_loopback(address)) << address;
  for (const char* address :
       {"0.0.0.0", "::", "192.168.1.2", "127.evil.example", "", "::ffff:1.2.3.4"})
    EXPECT_FALSE(is_loopback(address)) << address;
}

TEST(Orders, AreThoseOfThePage) {
  const auto stop = read_order(R"({"action":"stop","argument":"hand in the cell"})");
  ASSERT_TRUE(stop);
  EXPECT_EQ(stop->kind, OrderKind::stop);
  EXPECT_EQ(stop->target, "gate");
  EXPECT_EQ(stop->argument, "hand in the cell");
  EXPECT_EQ(read_order(R"({"action":"record","argument":"start"})")->target, "recorder");
  EXPECT_EQ(read_order(R"({"action":"mode","argument":"direct"})")->target, "mapping");
  EXPECT_EQ(read_order(R"({"action":"show","argument":"TEA"})")->kind, OrderKind::start);
  EXPECT_EQ(read_order(R"({"action":"shown"})")->target, "demonstration");
  EXPECT_EQ(read_order(R"({"action":"lead","argument":"replayer"})")->target, "");
  for (const char* body :
       {"", "[]", "{}", "{\"action\":3}", "{\"action\":\"take over\"}", "{\"action\":\"release\"}",
        "{\"action\":\"release\",\"argument\":\"a\\nb\"}", "{\"action\":\"stop\""})
    EXPECT_FALSE(read_order(body)) << body;
  EXPECT_FALSE(read_order("{\"action\":\"stop\",\"argument\":\"" + std::string(128, 'x') + "\"}"));
}

}  // namespace
}  // namespace prehend::console
