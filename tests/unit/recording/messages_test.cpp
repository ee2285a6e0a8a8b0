// Messages of other stacks: the same values, whatever they were encoded in, and a reason where they
// cannot be decoded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/recording/mcap/writer.hpp"
#include "common/recording/messages/message_decoder.hpp"
#include "tests/support/foreign/foreign.hpp"
#include "tests/unit/recording/scratch.hpp"

namespace prehend::recording {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

class Messages : public ::testing::Test {
 protected:
  /// A message as it is decoded again, or why it is not.
  std::string decoded(const test::Schema& schema, const std::string& encoding,
                      const std::vector<std::uint8_t>& message) {
    const auto path = scratch_ / "one.mcap";
    {
      auto writer = mcap::Writer::create(path).value();
      const auto id = writer.add_schema(schema.name, schema.encoding, schema.data).value();
      const auto channel = writer.add_channel(id, "/topic", encoding).value();
      EXPECT_TRUE(writer.write(mcap::Message{channel, 1, 5, 5, message}));
      EXPECT_TRUE(writer.close());
    }
    auto reader = mcap::Reader::open(path).value();
    MessageDecoder decoder(reader);
    auto cursor = reader.messages();
    const auto read = cursor.next().value().value();
    const auto value = decoder.decode(*read.channel, read.message.data);
    return value ? types::to_json(*value).dump() : value.error().message();
  }

  const testing::Scratch scratch_;
};

TEST_F(Messages, SayTheSameInEveryEncoding) {
  for (const test::Stack stack : test::all_stacks) {
    const auto encoding = test::encoding_of(stack);
    const Json joints =
        Json::parse(decoded(test::joints_schema(stack), encoding,
                            test::message(stack, test::Joints{{"a", "b"}, {0.25, -3}, {1, 2}})));
    EXPECT_EQ(joints["name"], (Json{"a", "b"})) << joints;
    EXPECT_EQ(joints["position"], (Json{0.25, -3.0})) << joints;
    const Json place =
        Json::parse(decoded(test::place_schema(stack), encoding,
                            test::message(stack, test::Place{{1, 2, 3}, {0, 0, 0.6, 0.8}})));
    EXPECT_EQ(place["pose"]["position"]["z"], 3.0) << place;
    EXPECT_EQ(place["pose"]["orientation"]["w"], 0.8) << place;
    const Json picture = Json::parse(
        decoded(test::picture_schema(stack), encoding, test::picture_message(stack, "\xff\xd8!")));
    EXPECT_EQ(picture["data"], "/9gh") << picture;
    const Json yes =
        Json::parse(decoded(test::yes_schema(stack), encoding, test::yes_message(stack, true)));
    EXPECT_EQ(yes["data"], true);
  }
}

TEST_F(Messages, OfRos1HaveTimes) {
  const Json joints =
      Json::parse(decoded(test::joints_schema(test::Stack::ros1), "ros1",
                          test::message(test::Stack::ros1, test::Joints{{"a"}, {1}, {1}})));
  EXPECT_EQ(joints["header"]["seq"], 7);
  EXPECT_EQ(joints["header"]["stamp"]["secs"], 1'700'000'000);
  EXPECT_EQ(joints["header"]["stamp"]["nsecs"], 5);
  EXPECT_EQ(joints["header"]["frame_id"], "base");
}

TEST_F(Messages, ThatCannotBeDecodedSayWhyAndHowTheyAreEncoded) {
  const std::vector<std::uint8_t> text{'{', '}', '?'};
  const auto joints = test::joints_schema(test::Stack::ros2msg);
  EXPECT_THAT(decoded(joints, "flatbuffer", text),
              HasSubstr("only CDR, ROS 1, JSON and protobuf are read, encoding «flatbuffer»"));
  EXPECT_THAT(decoded({"A", "jsonschema", "{}"}, "json", text),
              HasSubstr("it is no JSON, encoding «json», schema A (jsonschema)"));
  EXPECT_THAT(decoded({"A", "jsonschema", "{}"}, "json", {'[', ']'}), HasSubstr("no object"));
  EXPECT_THAT(decoded({"other.No", "protobuf", test::joints_schema(test::Stack::protobuf).data},
                      "protobuf", text),
              HasSubstr("not in its description"));
  EXPECT_THAT(decoded({"A", "protobuf", "\x01\x02\x03"}, "protobuf", text),
              HasSubstr("no FileDescriptorSet"));
  EXPECT_THAT(decoded({"A", "odd", ""}, "ros1", text), HasSubstr("not described"));
  EXPECT_THAT(decoded(joints, "cdr", {0, 1, 0, 0, 9}), HasSubstr("ends too early"));
  const std::string deep = std::string(100'000, '[');
  EXPECT_THAT(decoded({"A", "jsonschema", "{}"}, "json",
                      std::vector<std::uint8_t>(deep.begin(), deep.end())),
              HasSubstr("too deep"));
}

}  // namespace
}  // namespace prehend::recording
