// What clients are given: late ones, slow ones, and those who ask for what is not there.
#include "services/console/core/hub.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "common/base/random.hpp"
#include "services/console/core/round.hpp"

namespace prehend::console {
namespace {

Payload text(std::string words) {
  return std::make_shared<const std::string>(std::move(words));
}

Hub::Options two_channels() {
  Hub::Options options;
  options.session = "1";
  options.channels = {
      {{0, "/scene", "json", "foxglove.SceneUpdate", "jsonschema", "{}"}, false, "", ""},
      {{0, "/log", "json", "foxglove.Log", "jsonschema", "{}"}, true, "", ""}};
  options.max_queued = 4;
  options.max_control = 8;
  return options;
}

std::vector<Frame> drain(Hub& hub, Hub::Client client) {
  std::vector<Frame> frames;
  while (auto frame = hub.next(client)) frames.push_back(*frame);
  return frames;
}

nlohmann::json document(const Frame& frame) {
  return nlohmann::json::parse(*frame.payload);
}

/// Connects, takes what a server says first, and watches both channels as 10 and 11.
Hub::Client watch(Hub& hub) {
  const Hub::Client client = hub.connect();
  drain(hub, client);
  hub.hear(client, R"({"op":"subscribe","subscriptions":[{"id":10,"channelId":0},
                                                          {"id":11,"channelId":1}]})");
  return client;
}

TEST(Hub, GreetsAndAdvertises) {
  Hub hub(two_channels());
  const auto frames = drain(hub, hub.connect());
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_FALSE(frames[0].binary);
  EXPECT_EQ(document(frames[0])["op"], "serverInfo");
  EXPECT_EQ(document(frames[0])["sessionId"], "1");
  const auto channels = document(frames[1])["channels"];
  ASSERT_EQ(channels.size(), 2U);
  EXPECT_EQ(channels[1]["id"], 1);
  EXPECT_EQ(channels[1]["topic"], "/log");
  EXPECT_EQ(channels[1]["schemaEncoding"], "jsonschema");
}

// Layout: opcode 1, subscription (u32), time (u64), both little endian, then the payload.
TEST(Hub, FramesHaveTheBytesOfTheProtocol) {
  Hub hub(two_channels());
  const auto client = watch(hub);
  hub.publish(0, "hand", 0x0102030405060708, text("{}"));
  const auto frames = drain(hub, client);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_TRUE(frames[0].binary);
  EXPECT_EQ(frames[0].head,
            std::string("\x01\x0a\x00\x00\x00\x08\x07\x06\x05\x04\x03\x02\x01", 13));
  EXPECT_EQ(*frames[0].payload, "{}");
}

TEST(Hub, LateOnesAreToldTheLastOfEverythingThatIsStillThere) {
  Hub hub(two_channels());
  hub.publish(0, "hand", 1, text("old hand"));
  hub.publish(0, "cup", 1, text("cup"));
  hub.publish(0, "hand", 2, text("hand"));
  hub.publish(0, "gone", 2, text("gone"));
  hub.forget(0, "gone");
  for (int i = 0; i < 6; ++i) hub.publish(1, std::to_string(i), i, text(std::to_string(i)));
  std::string told;
  for (const Frame& frame : drain(hub, watch(hub))) told += *frame.payload + " ";
  // Channels take turns; of the queued one the last four are kept.
  EXPECT_EQ(told, "2 cup 3 hand 4 5 ");
  EXPECT_EQ(hub.dropped(), 0U) << "what was before them they have not missed";
}

TEST(Hub, ASlowOneGetsTheNewestIsToldWhatItMissedAndHarmsNobody) {
  Hub hub(two_channels());
  const auto slow = watch(hub), quick = watch(hub);
  for (int i = 0; i < 1000; ++i) {
    hub.publish(0, "hand", i, text("hand " + std::to_string(i)));
    hub.publish(1, std::to_string(i), i, text("log " + std::to_string(i)));
    EXPECT_EQ(drain(hub, quick).size(), 2U);
  }
  EXPECT_EQ(hub.dropped(), 999U + 996U);
  hub.tell_losses();
  hub.tell_losses();
  EXPECT_FALSE(hub.overflowed(slow));
  const auto frames = drain(hub, slow);
  ASSERT_EQ(frames.size(), 1U + 5U);
  EXPECT_EQ(document(frames[0])["op"], "status");
  EXPECT_EQ(document(frames[0])["message"],
            "too slow for all messages; missed 999 of /scene, 996 of /log");
  EXPECT_EQ(*frames[1].payload, "log 996");
  EXPECT_EQ(*frames[2].payload, "hand 999");
}

TEST(Hub, WhoIsThereIsToldTheLastOfWhatEndsAndWhoComesLaterNothing) {
  Hub hub(two_channels());
  const auto there = watch(hub);
  hub.publish(0, "cup", 1, text("gone"));
  hub.forget(0, "cup");
  EXPECT_TRUE(drain(hub, watch(hub)).empty());
  const auto frames = drain(hub, there);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(*frames[0].payload, "gone");
  hub.publish(0, "cup", 2, text("there again"));
  EXPECT_EQ(drain(hub, watch(hub)).size(), 1U);
  EXPECT_EQ(drain(hub, there).size(), 1U);
  EXPECT_EQ(hub.dropped(), 0U);
}

Hub::Options one_list() {
  Hub::Options options = two_channels();
  options.channels[0].opening = "[";
  options.channels[0].closing = "]";
  return options;
}

TEST(Hub, OfAListAllThatIsNewGoesAsOneWhoseBytesAreShared) {
  Hub hub(one_list());
  const auto quick = watch(hub), other = watch(hub), slow = watch(hub);
  hub.publish(0, "hand", 3, text("1"));
  hub.publish(0, "cup", 2, text("2,3"));
  auto first = drain(hub, quick), second = drain(hub, other);
  ASSERT_EQ(first.size(), 1U);
  ASSERT_EQ(second.size(), 1U);
  EXPECT_EQ(*first[0].payload, "[1,2,3]");
  EXPECT_EQ(first[0].head[5], 3) << "the stamp is the newest";
  EXPECT_EQ(first[0].payload.get(), second[0].payload.get());
  hub.publish(0, "hand", 4, text("4"));
  first = drain(hub, quick);
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(*first[0].payload, "[4]");
  EXPECT_EQ(*drain(hub, slow).at(0).payload, "[2,3,4]");
  EXPECT_EQ(hub.dropped(), 1U) << "the slow one never got the first hand";
  EXPECT_EQ(*drain(hub, watch(hub)).at(0).payload, "[2,3,4]") << "who comes late";
  hub.forget_all();
  hub.publish(0, "hand", 5, text("5"));
  EXPECT_EQ(*drain(hub, slow).at(0).payload, "[5]");
  EXPECT_EQ(hub.dropped(), 1U);
}

// A story that a client reads now and then, against a plain model of it.
TEST(Story, EveryReaderEndsWithTheNewestOfEveryKeyThatIsThere) {
  Random random(7);
  Story story(1000, 4);
  std::map<std::string, std::string> newest;
  struct Seen {
    Story::Reader reader;
    std::map<std::string, std::string> by_key;
    std::uint64_t got = 0, told = 0;
  };
  std::vector<Seen> all(3);
  std::uint64_t put = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string key(1, static_cast<char>('a' + static_cast<int>(9 * random.uniform(0, 1))));
    const std::string words = key + std::to_string(i);
    story.put(key, i, text(words));
    newest[key] = words;
    ++put;
    Seen& seen = all[static_cast<std::size_t>(i) % 3];
    if (random.uniform(0, 1) < 0.7) continue;
    while (const auto part = story.next(seen.reader)) {
      seen.by_key[part->payload->substr(0, 1)] = *part->payload;
      ++seen.got;
    }
    EXPECT_EQ(seen.by_key, newest);
    EXPECT_EQ(seen.got + story.missed(seen.reader), put) << "got or missed, each once";
  }
}

TEST(Hub, WhoAsksWithoutTakingAnswersIsLetGo) {
  Hub hub(two_channels());
  const auto client = hub.connect();
  for (int i = 0; i < 6; ++i) hub.hear(client, R"({"op":"getParameters","parameterNames":[]})");
  EXPECT_FALSE(hub.overflowed(client));
  hub.hear(client, R"({"op":"getParameters","parameterNames":[]})");
  EXPECT_TRUE(hub.overflowed(client));
  hub.disconnect(client);
  EXPECT_EQ(hub.clients(), 0U);
  EXPECT_FALSE(hub.next(client));
}

TEST(Hub, StopsAtTheUnsubscription) {
  Hub hub(two_channels());
  const auto client = watch(hub);
  EXPECT_TRUE(hub.watched(0));
  hub.publish(0, "hand", 1, text("x"));
  hub.hear(client, R"({"op":"unsubscribe","subscriptionIds":[10]})");
  EXPECT_FALSE(hub.watched(0));
  EXPECT_TRUE(hub.watched(1));
  hub.publish(0, "hand", 2, text("y"));
  EXPECT_TRUE(drain(hub, client).empty());
}

TEST(Hub, NobodyWritesThroughIt) {
  Hub hub(two_channels());
  const auto client = hub.connect();
  drain(hub, client);
  for (const char* asked : {R"({"op":"advertise","channels":[{"id":1,"topic":"robot/command"}]})",
                            R"({"op":"setParameters","parameters":[]})",
                            R"({"op":"fetchAsset","uri":"file:///etc/passwd"})",
                            R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]})"}) {
    hub.hear(client, asked);
    const auto frames = drain(hub, client);
    ASSERT_EQ(frames.size(), 1U) << asked;
    EXPECT_EQ(document(frames[0])["op"], "status") << asked;
  }
}

TEST(Hub, TellsWhoIsThere) {
  Hub hub(two_channels());
  const auto client = hub.connect();
  drain(hub, client);
  hub.set_graph({{"robot/state", {"simulation"}, {}}});
  EXPECT_TRUE(drain(hub, client).empty()) << "it did not ask";
  hub.hear(client, R"({"op":"subscribeConnectionGraph"})");
  auto told = document(drain(hub, client).at(0));
  EXPECT_EQ(told["publishedTopics"][0]["publisherIds"][0], "simulation");
  hub.set_graph({});
  told = document(drain(hub, client).at(0));
  EXPECT_EQ(told["removedTopics"][0], "robot/state");
}

TEST(Round, NobodyIsTooSlowForWhatOneTickHasReplaced) {
  Hub hub(two_channels());
  const Hub::Client client = watch(hub);
  Round round;
  for (int tick = 0; tick < 3; ++tick) {
    for (const char* words : {"a", "b", "c"}) round.put(0, "hand", 1, text(words), false);
    for (const char* key : {"1", "2"})
      round.put(1, key + std::to_string(tick), 1, text(key), false);
    round.tell(hub);
    const auto frames = drain(hub, client);
    ASSERT_EQ(frames.size(), 3U);
    EXPECT_TRUE(std::ranges::any_of(frames, [](const Frame& one) { return *one.payload == "c"; }));
  }
  EXPECT_EQ(hub.dropped(), 0U);
}

TEST(Round, WhatEndsInTheTickIsNotKeptForLateOnes) {
  Hub hub(two_channels());
  Round round;
  round.put(0, "hand", 1, text("there"), false);
  round.put(0, "hand", 0, nullptr, true);
  round.put(0, "object", 1, text("gone"), true);
  round.put(0, "object", 2, text("there again"), false);
  round.tell(hub);
  const auto frames = drain(hub, watch(hub));
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(*frames[0].payload, "there again");
}

// Layout of the request: opcode 3, command, speed (f32), whether it seeks, time (u64), id.
TEST(Hub, ARecordingIsLedByWhoeverLooks) {
  Hub::Options options = two_channels();
  options.recording = Span{1'500'000'000, 9'000'000'000};
  Hub hub(options);
  const auto client = watch(hub);
  const auto other = hub.connect();
  const auto info = document(drain(hub, other)[0]);
  EXPECT_EQ(info["dataStartTime"], (nlohmann::json{{"sec", 1}, {"nsec", 500000000}}));
  EXPECT_EQ(info["capabilities"].back(), "playbackControl");
  const std::string request(
      "\x03\x01\x00\x00\x00\x3f\x01\x08\x07\x06\x05\x04\x03\x02\x01"
      "\x02\x00\x00\x00id",
      21);
  hub.hear_bytes(client, request);
  for (std::size_t size = 0; size < request.size(); ++size)
    hub.hear_bytes(client, std::string_view(request).substr(0, size));
  const auto asked = hub.take_requests();
  ASSERT_EQ(asked.size(), 1U);
  EXPECT_EQ(asked[0].play, false);
  EXPECT_EQ(asked[0].speed, 0.5);
  EXPECT_EQ(asked[0].seek_ns, 0x0102030405060708);
  EXPECT_EQ(asked[0].id, "id");
  EXPECT_TRUE(hub.take_requests().empty());

  hub.publish(0, "hand", 1, text("of another time"));
  hub.forget_all();
  hub.tell_playback({PlaybackState::Status::paused, 0x0102030405060708, 0.5, true, "id"});
  const auto frames = drain(hub, client);
  ASSERT_EQ(frames.size(), 1U) << "nothing of another time";
  EXPECT_TRUE(frames[0].binary);
  EXPECT_EQ(*frames[0].payload,
            std::string("\x05\x01\x08\x07\x06\x05\x04\x03\x02\x01\x00\x00\x00\x3f\x01"
                        "\x02\x00\x00\x00id",
                        21));
  EXPECT_EQ(drain(hub, other).size(), 0U) << "older viewers do not know such messages";

  const std::string only_asks("\x03\x02\x00\x00\x80\x3f\x00\0\0\0\0\0\0\0\0\0\0\0\0", 19);
  hub.hear_bytes(other, only_asks);
  EXPECT_FALSE(hub.take_requests().at(0).play);
  hub.tell_playback({});
  EXPECT_EQ(drain(hub, other).size(), 1U);
}

// A lab goes its own way.
TEST(Hub, ALabIsNotLed) {
  Hub hub(two_channels());
  hub.hear_bytes(hub.connect(),
                 std::string("\x03\x01\x00\x00\x80\x3f\x00\0\0\0\0\0\0\0\0\0\0\0\0", 19));
  EXPECT_TRUE(hub.take_requests().empty());
}

}  // namespace
}  // namespace prehend::console
