// The type tree made from idl/ must mean what Fast DDS makes of the same IDL. For random values of
// every topic type: our encoding, read and written again by Fast DDS, is the same bytes, and
// decoded it is the same value. Only a wrong order of equal neighbours could hide in that, so one
// type is compared field by field. All comparisons are exact.
//
// A description handed to others must say the same as the tree: a tree made from it decodes the
// same.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/dds/topics.hpp"
#include "common/recording/types/idl.hpp"
#include "common/recording/types/ros2idl.hpp"
#include "common/recording/types/schema_text.hpp"
#include "common/recording/types/value.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/recording/random_message.hpp"
#include "tests/unit/recording/scratch.hpp"

namespace prehend::recording::types {
namespace {

using prehend::testing::encode;
using prehend::testing::random_value;
using ::testing::HasSubstr;

const Library& contract() {
  static const Library library = load_idl(test::in_sources("idl")).value();
  return library;
}

/// The bytes, read into the generated type and written again.
template <class PubSub>
std::vector<std::uint8_t> through_fast_dds(std::vector<std::uint8_t> bytes) {
  using dds::rtps::SerializedPayload_t;
  PubSub support;
  typename PubSub::type message;
  SerializedPayload_t in(static_cast<std::uint32_t>(bytes.size()));
  std::copy(bytes.begin(), bytes.end(), in.data);
  in.length = static_cast<std::uint32_t>(bytes.size());
  EXPECT_TRUE(dds::deserialize(support, in, &message));
  SerializedPayload_t out(dds::serialized_size(support, &message));
  EXPECT_TRUE(dds::serialize(support, &message, out));
  return {out.data, out.data + out.length};
}

template <class PubSub>
class EveryTopic : public ::testing::Test {};

using TopicTypes =
    ::testing::Types<v1::GloveFramePubSubType, v1::HandPosturePubSubType, v1::CameraImagePubSubType,
                     v1::ObjectDetectionPubSubType, v2::HandCommandPubSubType,
                     v1::HandStatePubSubType, v1::SceneStatePubSubType, v1::ObjectStatePubSubType,
                     v1::GraspReportPubSubType, v1::OperatorCommandPubSubType,
                     v1::OperatorReplyPubSubType, v2::LabClockPubSubType, v1::LabProgressPubSubType,
                     v1::ServiceSettingsPubSubType, v1::ServiceStatusPubSubType>;
TYPED_TEST_SUITE(EveryTopic, TopicTypes);

template <class PubSub>
const Structure& type_of() {
  const Structure* type = contract().find(dds::name_of(PubSub()));
  if (!type) throw std::runtime_error("not in the contract");
  return *type;
}

TYPED_TEST(EveryTopic, HasTheLayoutThatFastDdsGivesIt) {
  const Structure& type = type_of<TypeParam>();
  Random random(7);
  for (int i = 0; i < 100; ++i) {
    const Value value = random_value(type, random);
    const auto bytes = encode(type, value);
    ASSERT_EQ(through_fast_dds<TypeParam>(bytes), bytes);
    ASSERT_EQ(to_json(decode(type, bytes).value()), to_json(value));
    // The other byte order says the same.
    ASSERT_EQ(to_json(decode(type, encode(type, value, true)).value()), to_json(value));
  }
}

TYPED_TEST(EveryTopic, IsDecodedTheSameByItsDescriptions) {
  const Structure& type = type_of<TypeParam>();
  Library by_ros2, by_idl, by_source;
  const Structure* ros2 = parse_ros2msg(ros2_name(type.name), ros2msg(type), by_ros2).value();
  ASSERT_TRUE(parse_idl(omgidl(type), "omgidl", by_idl));
  ASSERT_TRUE(parse_idl(*type.source, "source", by_source));
  const Structure* idl = by_idl.find(type.name);
  const Structure* source = by_source.find(type.name);
  ASSERT_TRUE(idl && source);
  EXPECT_EQ(omgidl(*idl), omgidl(type));
  EXPECT_EQ(omgidl(*source), omgidl(type));
  Random random(11);
  for (int i = 0; i < 20; ++i) {
    const Value value = random_value(type, random);
    const auto bytes = encode(type, value);
    EXPECT_EQ(to_json(decode(*idl, bytes).value()), to_json(value));
    // Enumerations are plain numbers there.
    const Value plain = decode(*ros2, bytes).value();
    for (const Field& field : type.fields) {
      if (field.type.kind == Kind::enumeration || field.type.kind == Kind::structure) continue;
      EXPECT_EQ(to_json(*plain.find(ros2_field_name(field.name))),
                to_json(*value.find(field.name)));
    }
  }
}

TYPED_TEST(EveryTopic, CutShortIsAFailureThatNamesTheField) {
  const Structure& type = type_of<TypeParam>();
  Random random(13);
  for (int i = 0; i < 5; ++i) {
    const auto bytes = encode(type, random_value(type, random));
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      const auto value = decode(type, std::span(bytes).first(length));
      ASSERT_FALSE(value) << length << " of " << bytes.size();
      EXPECT_THAT(value.error().where, HasSubstr(type.name));
    }
  }
}

TEST(Types, AFingertipIsWhereItWasPut) {
  v1::HandPosture posture;
  posture.glove("right");
  posture.origin_ns(-5);
  posture.X_WH().orientation().w(0.25);
  posture.fingertips()[2].valid(true);
  posture.fingertips()[2].p_HF().y(1.5);
  posture.joint_angles({1, 2});
  v1::HandPosturePubSubType support;
  dds::rtps::SerializedPayload_t payload(dds::serialized_size(support, &posture));
  ASSERT_TRUE(dds::serialize(support, &posture, payload));
  const auto json =
      to_json(decode(type_of<v1::HandPosturePubSubType>(), std::span(payload.data, payload.length))
                  .value());
  EXPECT_EQ(json["glove"], "right");
  EXPECT_EQ(json["origin_ns"], -5);
  EXPECT_EQ(json["X_WH"]["orientation"]["w"], 0.25);
  EXPECT_EQ(json["fingertips"][2]["valid"], true);
  EXPECT_EQ(json["fingertips"][2]["p_HF"]["y"], 1.5);
  EXPECT_EQ(json["fingertips"][1]["valid"], false);
  EXPECT_EQ(json["joint_angles"], (std::vector<double>{1, 2}));
}

TEST(Types, LengthsThatLieAreRefusedBeforeMemoryIsTaken) {
  Library library;
  ASSERT_TRUE(parse_idl("struct A { sequence<double> x; };", "test", library));
  const std::vector<std::uint8_t> bytes{0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff};
  EXPECT_FALSE(decode(*library.find("A"), bytes));
}

TEST(Types, EncapsulationsOtherThanCdrAreRefused) {
  Library library;
  ASSERT_TRUE(parse_idl("struct A { octet x; };", "test", library));
  EXPECT_TRUE(decode(*library.find("A"), std::vector<std::uint8_t>{0, 1, 0, 0, 9}));
  EXPECT_FALSE(decode(*library.find("A"), std::vector<std::uint8_t>{0, 3, 0, 0, 9}));
  EXPECT_FALSE(decode(*library.find("A"), std::vector<std::uint8_t>{1, 1, 0, 0, 9}));
}

TEST(Idl, SaysWhatIsWrongAndInWhichLine) {
  const auto refused = [](const char* text) {
    Library library;
    const auto parsed = parse_idl(text, "a.idl", library);
    return parsed ? std::string("parsed") : parsed.error().message();
  };
  EXPECT_THAT(refused("struct A {\n  Nothing x;\n};"), HasSubstr("a.idl line 2: the type Nothing"));
  EXPECT_THAT(refused("union U switch(long) {};"), HasSubstr("union"));
  EXPECT_THAT(refused("struct A { long x }"), HasSubstr("«;» is missing"));
  EXPECT_THAT(refused("struct A { long x[0]; };"), HasSubstr("impossible size"));
  EXPECT_THAT(refused("struct A { sequence<sequence<long>> x; };"), HasSubstr("collections"));
  EXPECT_THAT(refused("struct A { long x; };\nstruct A { long x; };"), HasSubstr("twice"));
  EXPECT_THAT(refused("module a { struct A {"), HasSubstr("is missing"));
  EXPECT_THAT(refused("/* never ends"), ::testing::Eq("parsed"));
  EXPECT_THAT(refused("@"), HasSubstr("name"));
}

// Fuzzing found that depth of a text became depth of the stack.
TEST(Idl, RefusesNestingWithoutEnd) {
  const auto refused = [](const std::string& text) {
    Library library;
    const auto parsed = parse_idl(text, "a.idl", library);
    return parsed ? std::string("parsed") : parsed.error().message();
  };
  std::string modules, sequences = "struct A { ", structures = "struct A0 { octet x; };\n";
  for (int i = 0; i < 100'000; ++i) modules += "module a { ", sequences += "sequence<";
  for (int i = 1; i < 20'000; ++i)
    structures += "struct A" + std::to_string(i) + " { A" + std::to_string(i - 1) + " x; };\n";
  EXPECT_THAT(refused(modules), HasSubstr("modules"));
  EXPECT_THAT(refused(sequences), HasSubstr("collections"));
  EXPECT_THAT(refused(structures), HasSubstr("A64 has too many structures"));
}

TEST(Idl, AFileThatIncludesNothingThatCanBeReadIsNamed) {
  const prehend::testing::Scratch scratch;
  const auto refused = [&](const std::string& text) {
    prehend::testing::write_bytes(scratch / "a.idl", text);
    return load_idl((scratch / "a.idl").parent_path()).error().message();
  };
  EXPECT_THAT(refused("#include <b.idl>\n"), HasSubstr("a.idl: an include without a file name"));
  EXPECT_THAT(refused("#include \"b.idl\"\n"), HasSubstr("b.idl: cannot be read"));
}

TEST(Ros2Idl, RefusesPartsWithoutEnd) {
  std::string text;
  for (int i = 0; i < 300; ++i) text += "===\nIDL: a/msg/A\nstruct A { long x; };\n";
  Library library;
  EXPECT_EQ(parse_ros2idl("a/msg/A", text, library).error().what,
            "its description has too many parts");
}

TEST(Ros2Msg, RefusesNestingWithoutEnd) {
  std::string text = "a/A0 x\n";
  for (int i = 0; i < 5'000; ++i)
    text += "===\nMSG: a/A" + std::to_string(i) + "\na/A" + std::to_string(i + 1) + " x\n";
  Library library;
  EXPECT_FALSE(parse_ros2msg("a/msg/A", text, library));
}

// Arrays of nothing take no bytes: with them a short message could hold any number of structures.
TEST(Ros2Msg, RefusesArraysOfNothing) {
  Library library;
  EXPECT_FALSE(parse_ros2msg("a/msg/A", "uint8[0] x\n", library));
}

TEST(Idl, ReadsWhatTheContractDoesNotUse) {
  Library library;
  ASSERT_TRUE(parse_idl(R"(
    module a { const long n = 3; typedef sequence<double, n> Row; enum E { @value(4) P, Q };
    module b { @final struct S { Row row; long grid[2][n]; ::a::E e; unsigned short u, w; }; }; };
    )",
                        "test", library));
  const Structure& type = *library.find("a::b::S");
  EXPECT_EQ(type.find("row")->type.count, 3u);
  EXPECT_EQ(type.find("grid")->type.count, 6u);
  EXPECT_EQ(type.find("e")->type.enumeration->name_of(5), "Q");
  EXPECT_EQ(type.find("w")->type.kind, Kind::uint16);
}

TEST(Ros2Msg, ReadsWhatOthersWrite) {
  Library library;
  const Structure* type = parse_ros2msg("sensor_msgs/msg/JointState", R"(# a comment
std_msgs/Header header
string[] name   # joints
float64[] position
uint8 FLAG = 3
uint8 OTHER=4
string<=5 note "default"
float32[3] fixed
int32[<=4] few
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
)",
                                        library)
                              .value();
  ASSERT_EQ(type->fields.size(), 6u);
  EXPECT_EQ(type->fields[0].type.structure->fields[0].type.structure->fields[1].name, "nanosec");
  EXPECT_EQ(type->fields[3].type.string_bound, 5u);
  EXPECT_EQ(type->fields[4].type.many, Type::Many::array);
  EXPECT_EQ(type->fields[5].type.many, Type::Many::sequence);
}

TEST(Ros2Msg, RefusesTypesThatContainThemselvesOrAreMissing) {
  Library library;
  EXPECT_FALSE(parse_ros2msg("a/msg/A", "a/A x\n", library));
  EXPECT_FALSE(parse_ros2msg("a/msg/B", "b/Missing x\n", library));
  EXPECT_FALSE(parse_ros2msg("a/msg/C", "int32[x] y\n", library));
}

}  // namespace
}  // namespace prehend::recording::types
