#include "common/recording/compare/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

namespace prehend::recording {
namespace {

using recording::types::Value;

/// What decides who is whose partner.
struct Key {
  std::string keys;  // key fields of the type, or the instance that ended
  std::string by;    // origin, stamp, sequence, place, disposed, unregistered
  std::int64_t number = 0;
  auto operator<=>(const Key&) const = default;

  std::string text() const {
    std::string result = by == "origin" || by == "stamp"
                             ? fmt::format("{} {:.6f} s", by, static_cast<double>(number) * 1e-9)
                             : fmt::format("{} {}", by, number);
    if (!keys.empty()) result += ", " + keys;
    return result;
  }
};

std::int64_t number_of(const Value& message, std::string_view field) {
  const Value* value = message.find(field);
  if (!value) return 0;
  if (const auto* number = std::get_if<std::int64_t>(&value->content)) return *number;
  if (const auto* number = std::get_if<std::uint64_t>(&value->content))
    return static_cast<std::int64_t>(*number);
  return 0;
}

std::string text_of(const Value& value) {
  if (const auto* number = std::get_if<double>(&value.content)) return fmt::format("{}", *number);
  if (const auto* bytes = std::get_if<Value::Bytes>(&value.content))
    return fmt::format("{} bytes", bytes->size());
  // Strings of a damaged recording may be no UTF-8.
  return to_json(value).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

/// Compares two values of one type and takes note of what differs.
class FieldComparison {
 public:
  FieldComparison(const ToleranceTable& tolerances, std::string_view type, Difference where)
      : tolerances_(tolerances), type_(type), where_(std::move(where)) {}

  /// `path` is without indices, for the table; `shown` with them, for people.
  void compare(const Value& a, const Value& b, const std::string& path, const std::string& shown) {
    if (a.content.index() != b.content.index()) {  // the type was changed in between
      note(shown, text_of(a), text_of(b), 0);
      return;
    }
    if (const auto* fields = std::get_if<Value::Fields>(&a.content)) {
      for (const auto& [name, value] : *fields) {
        const std::string dot = path.empty() ? "" : ".";
        const std::string field = fmt::format("{}{}{}", shown, dot, name);
        if (const Value* other = b.find(name))
          compare(value, *other, fmt::format("{}{}{}", path, dot, name), field);
        else
          note(field, text_of(value), "no such field", 0);
      }
      return;
    }
    const Tolerance tolerance = tolerances_.of(type_, path);
    if (tolerance.ignored) return;
    if (const auto* list = std::get_if<Value::List>(&a.content)) {
      const auto& other = std::get<Value::List>(b.content);
      if (list->size() != other.size()) {
        note(fmt::format("{} (length)", shown), std::to_string(list->size()),
             std::to_string(other.size()), 0);
        return;
      }
      for (std::size_t i = 0; i < list->size(); ++i)
        compare((*list)[i], other[i], path, fmt::format("{}[{}]", shown, i));
      return;
    }
    if (!same(a, b, tolerance)) note(shown, text_of(a), text_of(b), tolerance.absolute);
  }

  std::vector<Difference> found;

 private:
  static bool same(const Value& a, const Value& b, const Tolerance& tolerance) {
    if (const auto* x = std::get_if<double>(&a.content)) {
      const double y = std::get<double>(b.content);
      if (*x == y || (std::isnan(*x) && std::isnan(y))) return true;
      return std::abs(*x - y) <=
             tolerance.absolute + tolerance.relative * std::max(std::abs(*x), std::abs(y));
    }
    if (const auto* x = std::get_if<std::int64_t>(&a.content))
      return near(*x, std::get<std::int64_t>(b.content), tolerance);
    if (const auto* x = std::get_if<std::uint64_t>(&a.content))
      return near(*x, std::get<std::uint64_t>(b.content), tolerance);
    if (const auto* x = std::get_if<recording::types::Enumerator>(&a.content))
      return x->value == std::get<recording::types::Enumerator>(b.content).value;
    if (const auto* x = std::get_if<Value::Bytes>(&a.content))
      return *x == std::get<Value::Bytes>(b.content);
    if (const auto* x = std::get_if<std::string>(&a.content))
      return *x == std::get<std::string>(b.content);
    return std::get<bool>(a.content) == std::get<bool>(b.content);
  }

  // Whole numbers are compared as they are: a double has no room for nanoseconds since 1970.
  template <class Whole>
  static bool near(Whole x, Whole y, const Tolerance& tolerance) {
    const auto distance = x > y ? static_cast<std::uint64_t>(x) - static_cast<std::uint64_t>(y)
                                : static_cast<std::uint64_t>(y) - static_cast<std::uint64_t>(x);
    const double size =
        std::max(std::abs(static_cast<double>(x)), std::abs(static_cast<double>(y)));
    return distance == 0 ||
           static_cast<double>(distance) <= tolerance.absolute + tolerance.relative * size;
  }

  void note(std::string field, std::string expected, std::string actual, double tolerance) {
    Difference difference = where_;
    difference.field = std::move(field);
    difference.expected = std::move(expected);
    difference.actual = std::move(actual);
    difference.tolerance = tolerance;
    found.push_back(std::move(difference));
  }

  const ToleranceTable& tolerances_;
  std::string_view type_;
  Difference where_;
};

std::string_view unscoped(std::string_view name) {
  const std::size_t at = name.find_last_of(":/");
  return at == std::string_view::npos ? name : name.substr(at + 1);
}

// Of one sample not more differences are kept, so that others have room.
constexpr std::size_t max_of_a_sample = 4;

}  // namespace

/// What is known of a topic: samples that wait for their partner, and the report.
struct Comparison::Topic {
  struct Waiting {
    std::optional<Value> value;       // nothing when it is not decoded
    std::vector<std::uint8_t> bytes;  // then these
    std::string_view type;
  };
  using Place = std::pair<Key, std::uint64_t>;  // which, and the how manieth of these

  Key key_of(std::size_t side, const ComparedSample& sample, const std::optional<Value>& value);
  void compare(const Key& key, const Waiting& expected, const Waiting& actual,
               const ToleranceTable& tolerances);
  void keep_first(std::vector<Difference> differences);

  TopicReport report;
  std::size_t keep = 0;
  std::array<std::map<Place, Waiting>, 2> waiting;
  std::array<std::map<Key, std::uint64_t>, 2> seen;
  std::array<std::int64_t, 2> place{};
};

Key Comparison::Topic::key_of(std::size_t side, const ComparedSample& sample,
                              const std::optional<Value>& value) {
  const std::int64_t own_place = place[side]++;
  if (!sample.end.empty()) return {sample.end, "end", 0};
  if (!value) return {"", "place", own_place};
  Key key;
  for (const recording::types::Field& field : sample.type->fields)
    if (field.key)
      key.keys +=
          (key.keys.empty() ? "" : ", ") + field.name + " " + text_of(*value->find(field.name));
  for (const auto& [field, by] : {std::pair("origin_ns", "origin"), std::pair("stamp_ns", "stamp"),
                                  std::pair("sequence_number", "sequence")}) {
    key.number = number_of(*value, field);
    key.by = by;
    if (key.number != 0) return key;
  }
  key.by = "place";
  key.number = own_place;
  return key;
}

void Comparison::Topic::compare(const Key& key, const Waiting& expected, const Waiting& actual,
                                const ToleranceTable& tolerances) {
  ++report.compared;
  const Difference where{.stamp_ns = key.number, .sample = key.text()};
  std::vector<Difference> found;
  if (expected.value && actual.value) {
    FieldComparison fields(tolerances, unscoped(expected.type), where);
    fields.compare(*expected.value, *actual.value, "", "");
    found = std::move(fields.found);
  } else if (expected.bytes != actual.bytes ||
             expected.value.has_value() != actual.value.has_value()) {
    found.push_back(where);
    found.back().field = "(bytes)";
    found.back().expected = fmt::format("{} bytes", expected.bytes.size());
    found.back().actual = fmt::format("{} other bytes", actual.bytes.size());
  }
  if (found.empty()) return;
  ++report.different;
  if (found.size() > max_of_a_sample) found.resize(max_of_a_sample);
  keep_first(std::move(found));
}

void Comparison::Topic::keep_first(std::vector<Difference> differences) {
  auto& first = report.first;
  for (Difference& each : differences) {
    const auto at = std::ranges::upper_bound(first, each.stamp_ns, {}, &Difference::stamp_ns);
    if (at == first.end() && first.size() >= keep) return;
    first.insert(at, std::move(each));
    if (first.size() > keep) first.pop_back();
  }
}

Comparison::Comparison(const ToleranceTable& tolerances, std::size_t keep)
    : tolerances_(tolerances), keep_(keep) {}
Comparison::~Comparison() = default;

void Comparison::add(Side from, const ComparedSample& sample) {
  auto& slot = topics_[sample.topic];
  if (!slot) {
    slot = std::make_unique<Topic>();
    slot->report.name = sample.topic;
    slot->keep = keep_;
  }
  Topic& topic = *slot;
  const auto side = static_cast<std::size_t>(from), other = 1 - side;

  Topic::Waiting fresh;
  if (sample.type && sample.end.empty()) {
    fresh.type = sample.type->name;
    if (auto value = recording::types::decode(*sample.type, sample.payload))
      fresh.value = std::move(*value);
  }
  if (!fresh.value) fresh.bytes.assign(sample.payload.begin(), sample.payload.end());

  const Key key = topic.key_of(side, sample, fresh.value);
  const std::uint64_t nth = topic.seen[side][key]++;
  const auto partner = topic.waiting[other].find({key, nth});
  if (partner == topic.waiting[other].end()) {
    topic.waiting[side].emplace(Topic::Place{key, nth}, std::move(fresh));
    return;
  }
  const Topic::Waiting& expected = from == Side::expected ? fresh : partner->second;
  const Topic::Waiting& actual = from == Side::expected ? partner->second : fresh;
  topic.compare(key, expected, actual, tolerances_);
  topic.waiting[other].erase(partner);
  // Both sides have had as many: counting may start again, which keeps memory small.
  if (topic.seen[side][key] == topic.seen[other][key]) {
    topic.seen[side].erase(key);
    topic.seen[other].erase(key);
  }
}

Report Comparison::finish() {
  Report report;
  for (auto& [name, topic] : topics_) {
    for (const Side side : {Side::expected, Side::actual}) {
      for (const auto& [place, waiting] : topic->waiting[static_cast<std::size_t>(side)]) {
        const bool missing = side == Side::expected;
        ++(missing ? topic->report.missing : topic->report.extra);
        ++topic->report.different;
        topic->keep_first({Difference{.stamp_ns = place.first.number,
                                      .sample = place.first.text(),
                                      .field = {},
                                      .expected = missing ? "a sample" : "none",
                                      .actual = missing ? "none" : "a sample"}});
      }
    }
    report.topics.push_back(std::move(topic->report));
  }
  topics_.clear();
  return report;
}

std::string Difference::text() const {
  std::string result =
      field.empty() ? fmt::format("{}: expected {}, got {}", sample, expected, actual)
                    : fmt::format("{}: {}: expected {}, got {}", sample, field, expected, actual);
  if (tolerance > 0) result += fmt::format(" (tolerance {})", tolerance);
  return result;
}

bool Report::same() const {
  return std::ranges::all_of(topics, [](const TopicReport& each) { return each.different == 0; });
}

}  // namespace prehend::recording
