// Orders as services of the WebSocket: who is told of them, and that each call has one answer.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "services/console/core/access.hpp"
#include "services/console/core/bytes.hpp"
#include "services/console/core/desk.hpp"
#include "services/console/core/orders.hpp"

namespace prehend::console {
namespace {

using nlohmann::json;

/// As a client writes it.
std::string call_bytes(std::uint32_t service, std::uint32_t call, const std::string& request,
                       const std::string& encoding = "json") {
  std::string bytes = "\x02";
  put_number(bytes, service);
  put_number(bytes, call);
  put_number(bytes, static_cast<std::uint32_t>(encoding.size()));
  return bytes + encoding + request;
}

Hub hub_with_orders() {
  Hub::Options options;
  options.services = services_for_orders();
  options.max_calls = 2;
  return Hub(std::move(options));
}

std::vector<Frame> all_for(Hub& hub, Hub::Client client) {
  std::vector<Frame> frames;
  while (auto frame = hub.next(client)) frames.push_back(*frame);
  return frames;
}

/// Why its last call was refused; empty: it was not.
std::string refusal(Hub& hub, Hub::Client client) {
  const auto frames = all_for(hub, client);
  if (frames.size() != 1 || frames[0].binary) return "";
  const json said = json::parse(*frames[0].payload);
  EXPECT_EQ(said["op"], "serviceCallFailure");
  return said["message"].get<std::string>();
}

TEST(OrderServices, AreToldOfToThoseAloneWhoMayOrder) {
  Hub hub = hub_with_orders();
  const auto looks = all_for(hub, hub.connect());
  ASSERT_EQ(looks.size(), 2U);
  EXPECT_EQ(looks[0].payload->find("services"), std::string::npos) << *looks[0].payload;
  const auto orders = all_for(hub, hub.connect(true));
  ASSERT_EQ(orders.size(), 3U);
  const json greeting = json::parse(*orders[0].payload), told = json::parse(*orders[2].payload);
  EXPECT_EQ(greeting["supportedEncodings"], json::array({"json"}));
  EXPECT_NE(greeting["capabilities"].dump().find("\"services\""), std::string::npos);
  std::set<std::string> names;
  for (const json& service : told["services"]) {
    names.insert(service["name"].get<std::string>());
    EXPECT_EQ(service["id"], names.size() - 1);
    for (const char* side : {"request", "response"}) {
      EXPECT_EQ(service[side]["encoding"], "json");
      EXPECT_EQ(json::parse(service[side]["schema"].get<std::string>())["type"], "object");
    }
  }
  for (const char* name :
       {"stop", "release", "record", "replay", "mode", "show", "shown", "lead", "place", "consent"})
    EXPECT_TRUE(names.contains(std::string("/operator/") + name)) << name;
}

TEST(OrderServices, ACallThatMayNotBeIsRefusedAndGoesNowhere) {
  Hub hub = hub_with_orders();
  const auto viewer = hub.connect(), operator_ = hub.connect(true);
  all_for(hub, viewer);
  all_for(hub, operator_);
  hub.hear_bytes(viewer, call_bytes(0, 1, "{}"));
  EXPECT_EQ(refusal(hub, viewer), "viewers only look: orders need the page's token");
  hub.hear_bytes(operator_, call_bytes(99, 1, "{}"));
  EXPECT_EQ(refusal(hub, operator_), "there is no such service");
  hub.hear_bytes(operator_, call_bytes(0, 1, "{}", "cdr"));
  EXPECT_EQ(refusal(hub, operator_), "is not json");
  hub.hear_bytes(operator_, call_bytes(0, 1, "{}").substr(0, 9));
  EXPECT_TRUE(hub.take_calls().empty());
  for (std::uint32_t i = 0; i < 3; ++i) hub.hear_bytes(operator_, call_bytes(0, i, "{}"));
  EXPECT_EQ(refusal(hub, operator_), "too many orders wait for their answer");
  const auto calls = hub.take_calls();
  ASSERT_EQ(calls.size(), 2U);
  // What was answered makes place for the next one.
  hub.answer(calls[0], "{}");
  all_for(hub, operator_);
  hub.hear_bytes(operator_, call_bytes(0, 7, "{}"));
  ASSERT_EQ(hub.take_calls().size(), 1U);
  hub.disconnect(operator_);
  hub.answer(calls[1], "{}");  // nobody is there any more
}

TEST(OrderServices, AnAnswerCarriesTheNumbersOfItsCall) {
  Hub hub = hub_with_orders();
  const auto client = hub.connect(true);
  all_for(hub, client);
  hub.hear_bytes(client, call_bytes(3, 77, R"({"argument":"pause"})"));
  const auto calls = hub.take_calls();
  ASSERT_EQ(calls.size(), 1U);
  EXPECT_EQ(calls[0].asked.request, R"({"argument":"pause"})");
  hub.answer(calls[0], std::string("{\"a\":1}"));
  const auto frames = all_for(hub, client);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_TRUE(frames[0].binary);
  EXPECT_EQ(*frames[0].payload, std::string("\x03\x03\0\0\0\x4d\0\0\0\x04\0\0\0json{\"a\":1}", 24));
}

recording::types::Value reply(const std::string& id, bool done, const std::string& message,
                              const std::string& service = "mapping") {
  using recording::types::Value;
  Value::Fields fields;
  fields.push_back({"id", Value{id}});
  fields.push_back({"service", Value{service}});
  fields.push_back({"done", Value{done}});
  fields.push_back({"message", Value{message}});
  return Value{std::move(fields)};
}

Hub::Call call_of(std::uint32_t number) {
  return {1, {0, number, "json", "{}"}};
}

TEST(Desk, AnOrderIsAnsweredOnceByItsReply) {
  Desk desk;
  const Time now{};
  desk.add("a", false, call_of(1), now);
  desk.add("b", false, call_of(2), now);
  EXPECT_TRUE(desk.hear(View(reply("c", true, "of somebody else's"))).empty());
  const auto done = desk.hear(View(reply("a", true, "direct")));
  ASSERT_EQ(done.size(), 1U);
  EXPECT_EQ(done[0].call.asked.call, 1U);
  ASSERT_TRUE(done[0].document);
  EXPECT_EQ(json::parse(*done[0].document), (json{{"service", "mapping"}, {"message", "direct"}}));
  EXPECT_TRUE(desk.hear(View(reply("a", true, "again"))).empty());
  const auto refused = desk.hear(View(reply("b", false, "there is no such mode")));
  ASSERT_EQ(refused.size(), 1U);
  ASSERT_FALSE(refused[0].document);
  EXPECT_EQ(refused[0].document.error().message(), "mapping: there is no such mode");
  EXPECT_TRUE(desk.wait(now + std::chrono::hours(1)).empty());
}

TEST(Desk, WhatNobodyAnswersIsToldSo) {
  Desk desk;
  const Time now{};
  desk.add("a", false, call_of(1), now);
  EXPECT_TRUE(desk.wait(now + std::chrono::milliseconds(2900)).empty());
  const auto late = desk.wait(now + std::chrono::seconds(3));
  ASSERT_EQ(late.size(), 1U);
  ASSERT_FALSE(late[0].document);
  EXPECT_EQ(late[0].document.error().message(), "nobody answered within 3 s");
}

// Of an order to all, those who are not meant refuse: that is no answer while another may obey.
TEST(Desk, OfAnOrderToAllOneThatIsDoneCounts) {
  Desk desk;
  const Time now{};
  desk.add("a", true, call_of(1), now);
  desk.add("b", true, call_of(2), now);
  for (const char* id : {"a", "b"})
    EXPECT_TRUE(desk.hear(View(reply(id, false, "no such glove"))).empty());
  const auto done = desk.hear(View(reply("a", true, "leads", "gate")));
  ASSERT_EQ(done.size(), 1U);
  EXPECT_TRUE(done[0].document);
  const auto late = desk.wait(now + std::chrono::seconds(3));
  ASSERT_EQ(late.size(), 1U);
  EXPECT_EQ(late[0].document.error().message(), "mapping: no such glove");
}

TEST(OrderServices, NeedThePagesTokenAndNoForeignPage) {
  Policy policy{.hosts = names_of("127.0.0.1", 8765), .order_token = "0123456789abcdef"};
  policy.viewers = {"http://localhost:8080"};
  const auto orders = [&](const std::string& target, const std::string& origin) {
    const Verdict verdict =
        judge({"GET", target, "localhost:8765", origin, "", "", true, "foxglove.sdk.v1"}, policy);
    return verdict.route == Route::socket && verdict.orders;
  };
  const std::string own = "http://localhost:8765", good = "/?orders=0123456789abcdef";
  EXPECT_TRUE(orders(good, own));
  EXPECT_TRUE(orders(good, "")) << "a program on this machine";
  EXPECT_FALSE(orders("/", own));
  EXPECT_FALSE(orders("/?orders=0123456789abcdeF", own));
  EXPECT_FALSE(orders("/?orders=", own));
  EXPECT_FALSE(orders(good, "http://localhost:8080")) << "it may look";
  EXPECT_FALSE(orders(good, "https://evil.example"));
  policy.order_token.clear();
  EXPECT_FALSE(orders("/?orders=", own)) << "of a recording there is no token";
}

TEST(OrderServices, ReadTheirRequests) {
  const auto release = read_order("release", R"({"argument":"nobody is near"})");
  ASSERT_TRUE(release) << release.error().message();
  EXPECT_EQ(release->target, "gate");
  EXPECT_TRUE(read_order("stop", "{}"));
  EXPECT_FALSE(read_order("release", "{}")) << "it must say why";
  EXPECT_FALSE(read_order("release", R"({"argument":7})"));
  EXPECT_FALSE(read_order("place", R"({"argument":"Talc","x":3,"y":0})"));
  EXPECT_FALSE(read_order("move", R"({"argument":"a","action":"stop"})"));
  EXPECT_FALSE(read_order("stop", ""));
}

}  // namespace
}  // namespace prehend::console
