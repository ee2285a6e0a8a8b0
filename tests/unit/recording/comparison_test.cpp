// Two recordings are the same when every sample has a partner whose fields lie within the table's
// tolerances. Checked on random values of every topic type: a copy is the same; a copy with one
// number moved by less than the tolerance is the same, by more is different and the field is named.
#include "common/recording/compare/comparison.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/dds/topics.hpp"
#include "common/recording/types/idl.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/recording/random_message.hpp"

namespace prehend::recording {
namespace {

using prehend::testing::encode;
using prehend::testing::random_value;
using recording::types::Value;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;

const recording::types::Library& contract() {
  static const recording::types::Library library =
      recording::types::load_idl(test::in_sources("idl")).value();
  return library;
}

const ToleranceTable& defaults() {
  static const ToleranceTable table =
      ToleranceTable::load(test::in_sources("common/recording/compare/tolerances.toml")).value();
  return table;
}

Value& field(Value& message, std::string_view name) {
  return *const_cast<Value*>(message.find(name));
}

void add(Comparison& comparison, Side side, const recording::types::Structure& type,
         const Value& value) {
  const auto bytes = encode(type, value);
  comparison.add(side, {"topic", &type, bytes, {}});
}

/// Of all our topics.
std::vector<const recording::types::Structure*> topic_types() {
  std::vector<const recording::types::Structure*> result;
  for (const dds::TopicInfo& topic : dds::topic_table)
    result.push_back(contract().find(topic.type_name()));
  return result;
}

/// As the table names a type.
std::string unscoped(const std::string& type) {
  return type.substr(type.rfind(':') + 1);
}

/// Paths of the floating-point numbers in a type.
std::vector<std::string> numbers_in(const recording::types::Structure& type) {
  std::vector<std::string> paths;
  for (const recording::types::Field& field : type.fields) {
    if (field.type.kind == recording::types::Kind::float64) paths.push_back(field.name);
    if (!field.type.structure) continue;
    for (const std::string& path : numbers_in(*field.type.structure))
      paths.push_back(field.name + "." + path);
  }
  return paths;
}

TEST(Comparison, ACopyInAnyOrderIsTheSame) {
  for (const recording::types::Structure* type : topic_types()) {
    Random random(3);
    std::vector<Value> values;
    for (int i = 0; i < 30; ++i) {
      values.push_back(random_value(*type, random));
      for (const char* stamp : {"stamp_ns", "origin_ns"})
        if (type->find(stamp)) field(values.back(), stamp).content = std::int64_t{1000 + i};
    }
    Comparison comparison(defaults());
    for (const Value& value : values) add(comparison, Side::expected, *type, value);
    for (std::size_t i = 0; i < values.size(); ++i)
      add(comparison, Side::actual, *type, values[(i * 7) % values.size()]);
    const Report report = comparison.finish();
    EXPECT_TRUE(report.same()) << type->name << " " << report.topics[0].first[0].text();
    EXPECT_EQ(report.topics[0].compared, values.size());
  }
}

/// Moves the nth number found inside a value by an amount made from its tolerance; gives the path.
std::optional<std::string> move_number(Value& value, const std::string& type, std::string path,
                                       std::size_t& nth, double factor) {
  if (auto* fields = std::get_if<Value::Fields>(&value.content)) {
    for (auto& [name, each] : *fields)
      if (auto moved = move_number(
              each, type, path.empty() ? std::string(name) : path + "." + std::string(name), nth,
              factor))
        return moved;
  } else if (auto* list = std::get_if<Value::List>(&value.content)) {
    for (Value& each : *list)
      if (auto moved = move_number(each, type, path, nth, factor)) return moved;
  } else if (auto* number = std::get_if<double>(&value.content)) {
    if (nth-- != 0) return std::nullopt;
    const Tolerance tolerance = defaults().of(type, path);
    if (tolerance.ignored) return "ignored";
    // Rounding of the sum itself must not decide.
    *number += factor * (tolerance.absolute + tolerance.relative * std::abs(*number)) +
               (factor > 1 ? 1e-9 * std::abs(*number) : 0);
    return path;
  }
  return std::nullopt;
}

TEST(Comparison, EveryNumberIsHeldToItsTolerance) {
  for (const recording::types::Structure* type : topic_types()) {
    Random random(5);
    const std::string name = unscoped(type->name);
    const Value value = random_value(*type, random);
    for (std::size_t n = 0;; ++n) {
      bool any = false;
      for (const double factor : {0.5, 3.0}) {
        Value other = value;
        std::size_t nth = n;
        const auto path = move_number(other, name, "", nth, factor);
        if (!path) continue;
        any = true;
        Comparison comparison(defaults());
        add(comparison, Side::expected, *type, value);
        add(comparison, Side::actual, *type, other);
        const Report report = comparison.finish();
        if (*path == "ignored" || factor < 1) {
          EXPECT_TRUE(report.same()) << name << "." << *path;
        } else {
          ASSERT_FALSE(report.same()) << name << "." << *path;
          EXPECT_THAT(report.topics[0].first[0].text(),
                      HasSubstr(path->substr(0, path->find('.'))));
        }
      }
      if (!any) break;
    }
  }
}

TEST(Comparison, SamplesAreAlignedByOriginWhateverTheirStamp) {
  const recording::types::Structure& type = *contract().find("prehend::v2::HandCommand");
  Random random(2);
  Comparison comparison(defaults());
  Value value = random_value(type, random);
  for (int i = 0; i < 5; ++i) {
    field(value, "origin_ns").content = std::int64_t{100 + i};
    field(value, "weight").content = 0.1 * i;
    add(comparison, Side::expected, type, value);
    if (i == 3) continue;  // lost
    add(comparison, Side::actual, type, value);
  }
  const Report report = comparison.finish();
  EXPECT_EQ(report.topics[0].compared, 4u);
  EXPECT_EQ(report.topics[0].missing, 1u);
  EXPECT_EQ(report.topics[0].different, 1u);
  EXPECT_EQ(report.topics[0].first[0].stamp_ns, 103);
}

TEST(Comparison, TheFirstDifferencesAreTheEarliest) {
  const recording::types::Structure& type = *contract().find("prehend::v1::ObjectState");
  Random random(2);
  Comparison comparison(defaults(), 3);
  Value value = random_value(type, random);
  for (const std::int64_t stamp : {50, 20, 40, 10, 30}) {
    field(value, "stamp_ns").content = stamp;
    field(value, "sequence_number").content = std::uint64_t{1};
    add(comparison, Side::expected, type, value);
    field(value, "sequence_number").content = std::uint64_t{2};
    add(comparison, Side::actual, type, value);
  }
  const Report report = comparison.finish();
  EXPECT_EQ(report.topics[0].different, 5u);
  ASSERT_EQ(report.topics[0].first.size(), 3u);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(report.topics[0].first[i].stamp_ns, 10 * (i + 1));
  EXPECT_EQ(report.topics[0].first[0].field, "sequence_number");
  EXPECT_EQ(report.topics[0].first[0].expected, "1");
}

// Fuzzing found that a key of a damaged recording ended the program.
TEST(Comparison, StringsThatAreNoTextAreToldAllTheSame) {
  const recording::types::Structure& type = *contract().find("prehend::v2::HandCommand");
  Random random(2);
  Comparison comparison(defaults());
  Value value = random_value(type, random);
  field(value, "hand").content = std::string("\x83 hand");
  field(value, "object").content = std::string("a");
  add(comparison, Side::expected, type, value);
  field(value, "object").content = std::string("\xff");
  add(comparison, Side::actual, type, value);
  const Report report = comparison.finish();
  EXPECT_EQ(report.topics[0].different, 1u);
  EXPECT_THAT(report.topics[0].first[0].text(), HasSubstr(" hand"));
}

TEST(Comparison, EndsOfInstancesCount) {
  Comparison comparison(defaults());
  comparison.add(Side::expected, {"object/detection", nullptr, {}, "disposed 01"});
  comparison.add(Side::expected, {"object/detection", nullptr, {}, "disposed 02"});
  comparison.add(Side::actual, {"object/detection", nullptr, {}, "disposed 01"});
  const Report report = comparison.finish();
  EXPECT_EQ(report.topics[0].compared, 1u);
  EXPECT_EQ(report.topics[0].missing, 1u);
}

TEST(Comparison, MessagesOfUnknownTypeAreComparedByTheirBytes) {
  Comparison comparison(defaults());
  const std::vector<std::uint8_t> a{1, 2, 3}, b{1, 2, 4};
  for (const auto& bytes : {a, a}) comparison.add(Side::expected, {"t", nullptr, bytes, {}});
  for (const auto& bytes : {a, b}) comparison.add(Side::actual, {"t", nullptr, bytes, {}});
  const Report report = comparison.finish();
  EXPECT_EQ(report.topics[0].compared, 2u);
  EXPECT_EQ(report.topics[0].different, 1u);
}

TEST(ToleranceTable, NamesOnlyFieldsOfTheContract) {
  // A field that was renamed would silently lose its tolerance.
  for (const recording::types::Structure* type : topic_types()) {
    const std::string name = unscoped(type->name);
    for (const std::string& path : defaults().fields(name)) {
      const recording::types::Structure* at = type;
      std::string rest = path;
      while (at && !rest.empty()) {
        const std::string part = rest.substr(0, rest.find('.'));
        const recording::types::Field* found = at->find(part);
        EXPECT_TRUE(found) << name << "." << path;
        at = found ? found->type.structure : nullptr;
        rest = part.size() == rest.size() ? "" : rest.substr(part.size() + 1);
      }
    }
  }
}

TEST(ToleranceTable, NamesOnlyTypesOfTopics) {
  std::vector<std::string> known{"any"};
  for (const recording::types::Structure* type : topic_types())
    known.push_back(unscoped(type->name));
  EXPECT_THAT(known, IsSupersetOf(defaults().types()));
}

// Another libm or compiler rounds otherwise: a computed number that had to be equal to the last bit
// would differ there.
TEST(ToleranceTable, HasAToleranceForEveryNumberThatAServiceComputes) {
  int numbers = 0;
  for (const dds::TopicInfo& topic : dds::topic_table) {
    if (std::ranges::none_of(dds::role_names,
                             [&](const auto& role) { return is_output(role.first, topic); }))
      continue;
    for (const std::string& path : numbers_in(*contract().find(topic.type_name()))) {
      const Tolerance tolerance = defaults().of(unscoped(topic.type_name()), path);
      EXPECT_TRUE(tolerance.ignored || tolerance.absolute + tolerance.relative > 0)
          << topic.name << " " << path;
      ++numbers;
    }
  }
  EXPECT_GT(numbers, 50);
}

TEST(ToleranceTable, TheLongestPathCounts) {
  const auto table =
      ToleranceTable::parse("[any]\nnumber = 9\nz = 8\n[A]\nX = 1\n\"X.p\" = \"ignore\"\n", "t")
          .value();
  EXPECT_EQ(table.of("A", "X.q.x").absolute, 1);
  EXPECT_TRUE(table.of("A", "X.p.x").ignored);
  EXPECT_EQ(table.of("A", "Y").absolute, 9);
  EXPECT_EQ(table.of("B", "p.z").absolute, 8);
  EXPECT_EQ(ToleranceTable::parse("", "t").value().of("B", "x").absolute, 0);
}

TEST(ToleranceTable, SaysWhatIsWrong) {
  const auto refused = [](const char* text) {
    const auto table = ToleranceTable::parse(text, "t.toml");
    return table ? std::string("read") : table.error().message();
  };
  EXPECT_THAT(refused("[A]\nx = -1"), HasSubstr("0 or more"));
  EXPECT_THAT(refused("[A]\nx = nan"), HasSubstr("A.x is not a finite number"));
  EXPECT_THAT(refused("[A]\nx = \"no\""), HasSubstr("t.toml: A.x"));
  EXPECT_THAT(refused("[A]\nx = {absolut = 1}"), HasSubstr("absolut"));
  EXPECT_THAT(refused("x = 1"), HasSubstr("table"));
  EXPECT_THAT(refused("[A"), HasSubstr("t.toml"));
}

}  // namespace
}  // namespace prehend::recording
