// The key of a message by its IDL is the one that Fast DDS finds with its generated code: for every
// keyed type of the contract and random messages, in either byte order. Fast DDS sends it beside
// each sample; other writers do not, and their instances would merge.
#include "services/recorder/service/key_hash.hpp"

#include <gtest/gtest.h>

#include "common/recording/types/idl.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/recording/random_message.hpp"

namespace prehend::recorder {
namespace {

constexpr char odd_keys[] = R"(
module odd {
  enum Colour { RED, GREEN };
  @final struct Small { double a; @key octet b; @key unsigned short c; @key Colour d; };
  @final struct Exact { @key unsigned long long a; string s; @key long long b; };
  @final struct Long { @key octet a; @key unsigned long long b; @key octet c; };
  @final struct Listed { @key long numbers[3]; };
  @final struct Text { @key string<8> text; };
  @final struct Part { long x; };
  @final struct Nested { @key Part part; };
  @final struct Several { @key sequence<long, 4> many; };
  @final struct None { long x; };
}; )";

struct Odd {
  recording::types::Library library;
  Odd() {
    const auto parsed = recording::types::parse_idl(odd_keys, "odd.idl", library);
    EXPECT_TRUE(parsed) << parsed.error().message();
  }
  const recording::types::Structure& type(const std::string& name) {
    return *library.find("odd::" + name);
  }
};

using Bytes = std::vector<std::uint8_t>;

template <class PubSub>
void agrees(const recording::types::Library& contract, const std::string& name) {
  const recording::types::Structure* type = contract.find(name);
  ASSERT_NE(type, nullptr) << name;
  const auto hash = KeyHash::of(*type);
  ASSERT_TRUE(hash) << name;
  Random random(7);
  PubSub generated;
  for (int i = 0; i < 50; ++i) {
    const recording::types::Value value = prehend::testing::random_value(*type, random);
    Bytes bytes = prehend::testing::encode(*type, value);
    dds::rtps::SerializedPayload_t payload(static_cast<std::uint32_t>(bytes.size()));
    std::copy(bytes.begin(), bytes.end(), payload.data);
    payload.length = static_cast<std::uint32_t>(bytes.size());
    typename PubSub::type message;
    ASSERT_TRUE(dds::deserialize(generated, payload, &message));
    dds::rtps::InstanceHandle_t handle;
    ASSERT_TRUE(dds::find_key(generated, &message, handle));
    dds::Guid expected{};
    std::copy_n(static_cast<const std::uint8_t*>(handle.value), 16, expected.begin());
    EXPECT_EQ(hash->of_message(bytes), expected) << name;
    EXPECT_EQ(hash->of_message(prehend::testing::encode(*type, value, true)), expected) << name;
  }
}

TEST(KeyHash, IsTheOneOfFastDdsForEveryKeyedType) {
  const auto contract = recording::types::load_idl(test::in_sources("idl"));
  ASSERT_TRUE(contract) << contract.error().message();
  agrees<v1::GloveFramePubSubType>(*contract, "prehend::v1::GloveFrame");
  agrees<v1::HandPosturePubSubType>(*contract, "prehend::v1::HandPosture");
  agrees<v1::CameraImagePubSubType>(*contract, "prehend::v1::CameraImage");
  agrees<v1::ObjectDetectionPubSubType>(*contract, "prehend::v1::ObjectDetection");
  agrees<v2::HandCommandPubSubType>(*contract, "prehend::v2::HandCommand");
  agrees<v1::HandStatePubSubType>(*contract, "prehend::v1::HandState");
  agrees<v1::SceneStatePubSubType>(*contract, "prehend::v1::SceneState");
  agrees<v1::ObjectStatePubSubType>(*contract, "prehend::v1::ObjectState");
  agrees<v1::GraspReportPubSubType>(*contract, "prehend::v1::GraspReport");
  agrees<v1::LabProgressPubSubType>(*contract, "prehend::v1::LabProgress");
  agrees<v1::ServiceStatusPubSubType>(*contract, "prehend::v1::ServiceStatus");
}

// By the rules of DDSI-RTPS 9.6.4.8, worked out by hand.
TEST(KeyHash, SmallKeysAreTheirBigEndianBytes) {
  Odd odd;
  const Bytes small{0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x42, 0, 0x34, 0x12, 1, 0, 0, 0};
  EXPECT_EQ(KeyHash::of(odd.type("Small"))->of_message(small),
            (dds::Guid{0x42, 0, 0x12, 0x34, 0, 0, 0, 1}));
  // A string<8> can take 4 + 8 + 1 = 13 bytes.
  const Bytes text{0, 1, 0, 0, 3, 0, 0, 0, 'a', 'b', 0};
  EXPECT_EQ(KeyHash::of(odd.type("Text"))->of_message(text), (dds::Guid{0, 0, 0, 3, 'a', 'b', 0}));
  const Bytes listed{0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 255, 255, 255, 255};
  EXPECT_EQ(KeyHash::of(odd.type("Listed"))->of_message(listed),
            (dds::Guid{0, 0, 0, 1, 0, 0, 0, 2, 255, 255, 255, 255}));
  // Two times 8 bytes fill it exactly, the string between them is passed by.
  const Bytes exact{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 5, 0, 0,
                    0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 6};
  EXPECT_EQ(KeyHash::of(odd.type("Exact"))->of_message(exact),
            (dds::Guid{0, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0, 0, 0, 0, 0, 6}));
}

TEST(KeyHash, LongerKeysAreDigested) {
  Odd odd;
  // 1, 7 bytes of padding, 8 bytes, 1: 17 bytes, of which RFC 1321's MD5 is known from md5sum.
  const Bytes message{0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 3};
  EXPECT_EQ(KeyHash::of(odd.type("Long"))->of_message(message),
            (dds::Guid{0xd7, 0xd5, 0xd9, 0xa4, 0x43, 0x30, 0x92, 0x61, 0xea, 0x29, 0xbc, 0x56, 0x25,
                       0xde, 0x3d, 0x0a}));
}

TEST(KeyHash, WhatCannotBeToldIsNothing) {
  Odd odd;
  EXPECT_FALSE(KeyHash::of(odd.type("None")));
  EXPECT_FALSE(KeyHash::of(odd.type("Nested")));
  EXPECT_FALSE(KeyHash::of(odd.type("Several")));
  const auto hash = KeyHash::of(odd.type("Small"));
  EXPECT_FALSE(hash->of_message(Bytes{}));
  EXPECT_FALSE(hash->of_message(Bytes{0, 1, 0, 0, 1, 2}));
  EXPECT_FALSE(hash->of_message(Bytes{0, 3, 0, 0, 1, 2, 3, 4}));  // a parameter list
}

}  // namespace
}  // namespace prehend::recorder
