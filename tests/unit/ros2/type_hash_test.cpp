// What endpoints announce of their types is what REP 2011 computes from idl/ros2.
#include "common/ros2/nodes/type_hash.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <openssl/sha.h>

#include <array>
#include <map>

#include "common/recording/types/idl.hpp"
#include "common/ros2/nodes/nodes.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::ros2 {
namespace {

using recording::types::Field;
using recording::types::Kind;
using recording::types::Structure;
using recording::types::Type;

std::string without_end(const std::string& name) {  // one «_»
  return name.substr(0, name.size() - 1);
}

/// a::msg::dds_::B_ is a/msg/B.
std::string ros_name(const std::string& scoped) {
  const std::string package = scoped.substr(0, scoped.find("::"));
  return package + "/msg/" + without_end(scoped.substr(scoped.rfind("::") + 2));
}

/// IDL knows no byte beside uint8: here one is an octet, the other a uint8.
bool is_byte(const Structure& structure, const Field& field) {
  return structure.source->find("octet " + field.name) != std::string::npos;
}

int kind_number(const Structure& structure, const Field& field) {
  static const std::map<Kind, int> numbers{
      {Kind::structure, 1}, {Kind::uint8, 3},    {Kind::int32, 6},  {Kind::uint32, 7},
      {Kind::float64, 11},  {Kind::boolean, 15}, {Kind::string, 17}};
  return is_byte(structure, field) ? 16 : numbers.at(field.type.kind);
}

std::string described(const Structure& structure, std::map<std::string, std::string>& others) {
  std::string fields;
  for (const Field& field : structure.fields) {
    const Type& type = field.type;
    std::string nested;
    if (type.structure) {
      nested = ros_name(type.structure->name);
      if (!others.contains(nested)) {
        others[nested];
        others[nested] = described(*type.structure, others);
      }
    }
    const int many = type.many == Type::Many::one ? 0 : type.many == Type::Many::array ? 48 : 144;
    fields += fmt::format(
        R"({}{{"name": "{}", "type": {{"type_id": {}, "capacity": {}, "string_capacity": 0, )"
        R"("nested_type_name": "{}"}}}})",
        fields.empty() ? "" : ", ", without_end(field.name), kind_number(structure, field) + many,
        type.many == Type::Many::array ? type.count : 0, nested);
  }
  return fmt::format(R"({{"type_name": "{}", "fields": [{}]}})", ros_name(structure.name), fields);
}

std::string announced_by(const Structure& structure) {
  std::map<std::string, std::string> others;
  const std::string own = described(structure, others);
  std::string rest;
  for (const auto& [name, text] : others) rest += (rest.empty() ? "" : ", ") + text;
  const std::string whole =
      R"({"type_description": )" + own + R"(, "referenced_type_descriptions": [)" + rest + "]}";
  std::array<unsigned char, SHA256_DIGEST_LENGTH> hash{};
  SHA256(reinterpret_cast<const unsigned char*>(whole.data()), whole.size(), hash.data());
  std::string made = "typehash=RIHS01_";
  for (const unsigned char byte : hash) made += fmt::format("{:02x}", byte);
  return made + ";";
}

TEST(TypeHash, IsThatOfTheTypesInTheContract) {
  const auto types = recording::types::load_idl(test::in_sources("idl/ros2")).value();
  for (const auto& [name, announced] : announced_hashes()) {
    const Structure* structure = types.find(topic_of_nodes("any", std::string(name)).type);
    ASSERT_TRUE(structure) << name;
    EXPECT_EQ(announced, announced_by(*structure)) << name;
  }
}

// As ROS 2 and its packages publish them.
TEST(TypeHash, IsThePublishedOne) {
  const auto expect = [](std::string_view type, const std::string& hash) {
    EXPECT_EQ(announced_hash(type), "typehash=RIHS01_" + hash + ";") << type;
  };
  expect("std_msgs/String", "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18");
  expect("sensor_msgs/JointState",
         "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e");
  expect("sensor_msgs/CameraInfo",
         "b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275");
  expect("vision_msgs/Detection3DArray",
         "793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018");
  EXPECT_EQ(announced_hash("std_msgs/Nothing"), "");
}

}  // namespace
}  // namespace prehend::ros2
