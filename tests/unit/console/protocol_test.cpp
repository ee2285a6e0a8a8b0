#include "services/console/core/protocol.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "services/console/core/documents.hpp"

namespace prehend::console {
namespace {

TEST(Protocol, WhateverIsAskedThereIsAnAnswer) {
  for (const char* text : {"", "null", "[]", "{}", "{\"op\":7}", "{\"op\":\"\"}", "{", "\xff\xfe"})
    EXPECT_TRUE(std::holds_alternative<Refused>(read_request(text))) << text;
  const auto odd = read_request(
      R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1},{"id":1},7,
          {"id":4294967296,"channelId":1},{"id":1.5,"channelId":1},{"id":5,"channelId":6}]})");
  ASSERT_TRUE(std::holds_alternative<Subscribe>(odd));
  ASSERT_EQ(std::get<Subscribe>(odd).all.size(), 1U);
  EXPECT_EQ(std::get<Subscribe>(odd).all[0].subscription, 5U);
}

TEST(Protocol, ParametersAreThoseThatWereAskedFor) {
  const std::vector<Parameter> all{{"/robot_description", "<robot/>"}, {"/other", "x"}};
  const auto ask = [&](const char* text) {
    return nlohmann::json::parse(
        parameter_values(all, std::get<GetParameters>(read_request(text))));
  };
  EXPECT_EQ(ask(R"({"op":"getParameters","parameterNames":[],"id":"7"})")["parameters"].size(), 2U);
  const auto one = ask(R"({"op":"getParameters","parameterNames":["/other"]})");
  EXPECT_EQ(one["parameters"].size(), 1U);
  EXPECT_FALSE(one.contains("id"));
}

TEST(Documents, SchemasAreJsonAndNamePicturesAsBytes) {
  for (const FeedInfo& feed : feeds) {
    const auto schema = nlohmann::json::parse(json_schema(feed.feed));
    EXPECT_EQ(schema["type"], "object") << feed.topic;
    EXPECT_FALSE(schema["properties"].empty()) << feed.topic;
    EXPECT_EQ(schema["title"], feed.schema_name);
  }
  EXPECT_EQ(
      nlohmann::json::parse(json_schema(Feed::image))["properties"]["data"]["contentEncoding"],
      "base64");
}

}  // namespace
}  // namespace prehend::console
