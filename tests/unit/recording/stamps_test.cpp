// Time stamps inside a message are moved and nothing else. Checked on random values of every topic
// type by decoding before and after: all fields but those of 64 bits that end in _ns are the same,
// those are moved by exactly the shift, and 0 (no time) stays 0.
#include "common/recording/types/stamps.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/recording/types/idl.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/recording/random_message.hpp"

namespace prehend::recording::types {
namespace {

using Json = nlohmann::ordered_json;
using prehend::testing::encode;
using prehend::testing::random_value;

constexpr std::int64_t shift = 123'456'789'012;

std::int64_t moved(std::int64_t stamp) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(stamp) + shift);
}

/// What the message must say afterwards.
void move(Value& value, std::string_view name) {
  if (auto* fields = std::get_if<Value::Fields>(&value.content))
    for (auto& [field, each] : *fields) move(each, field);
  if (auto* list = std::get_if<Value::List>(&value.content))
    for (Value& each : *list) move(each, name);
  if (!name.ends_with("_ns")) return;
  if (auto* stamp = std::get_if<std::int64_t>(&value.content))
    *stamp = *stamp == 0 ? 0 : moved(*stamp);
}

TEST(Stamps, AreMovedAndNothingElse) {
  const Library contract = load_idl(test::in_sources("idl")).value();
  Random random(3);
  int stamped = 0;
  for (const auto& [name, type] : contract.structures())
    for (int i = 0; i < 50; ++i) {
      Value value = random_value(*type, random);
      if (i % 5 == 0 && type->find("origin_ns"))
        const_cast<Value*>(value.find("origin_ns"))->content = std::int64_t{0};
      auto bytes = encode(*type, value);
      const auto before = bytes;
      ASSERT_TRUE(move_stamps(*type, moved, bytes)) << name;
      move(value, "");
      EXPECT_EQ(bytes, encode(*type, value)) << name;
      stamped += bytes != before;
    }
  EXPECT_GT(stamped, 500);
}

TEST(Stamps, OfWhatIsCutShortOrOfTheOtherByteOrderAreLeft) {
  const Library contract = load_idl(test::in_sources("idl")).value();
  Random random(3);
  for (const auto& [name, type] : contract.structures()) {
    const Value value = random_value(*type, random);
    const auto whole = encode(*type, value);
    for (std::size_t length = 0; length < whole.size(); ++length) {
      auto bytes = whole;
      bytes.resize(length);
      const auto before = bytes;
      EXPECT_FALSE(move_stamps(*type, moved, bytes)) << name << " " << length;
      EXPECT_EQ(bytes, before);
    }
    auto big = encode(*type, value, true);
    EXPECT_FALSE(move_stamps(*type, moved, big));
  }
}

}  // namespace
}  // namespace prehend::recording::types
