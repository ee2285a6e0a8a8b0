#include "services/recorder/tools/dataset/field_path.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>

#include "common/base/base64.hpp"
#include "common/base/printable.hpp"
#include "services/recorder/tools/dataset/message.hpp"

namespace prehend::recorder::dataset {
namespace {

constexpr std::size_t max_numbers = 4096;  // of one field
constexpr std::size_t max_steps = 16;

tl::unexpected<Error> no_field(std::string_view text) {
  return fail("«" + printable(text) + "» is no field of a message", "",
              "names and places, as pose.position or position[2]");
}

/// Adds the numbers below; false where something is none.
bool add(const Value& value, const std::string& name, Flat& to) {
  if (to.numbers.size() > max_numbers) return false;
  const auto number = [&](double x) {
    to.numbers.push_back(x);
    to.names.push_back(name);
    return std::isfinite(x);
  };
  const auto inner = [&](const std::string& last) {
    return name.empty() ? last : name + "." + last;
  };
  if (const auto* yes = std::get_if<bool>(&value.content)) return number(*yes ? 1 : 0);
  if (const auto* x = std::get_if<double>(&value.content)) return number(*x);
  if (const auto* i = std::get_if<std::int64_t>(&value.content))
    return number(static_cast<double>(*i));
  if (const auto* u = std::get_if<std::uint64_t>(&value.content))
    return number(static_cast<double>(*u));
  if (const auto* list = std::get_if<Value::List>(&value.content)) {
    for (std::size_t i = 0; i < list->size(); ++i)
      if (!add((*list)[i], inner(std::to_string(i)), to)) return false;
    return true;
  }
  if (const auto* bytes = std::get_if<Value::Bytes>(&value.content)) {
    for (std::size_t i = 0; i < std::min(bytes->size(), max_numbers + 1); ++i)
      if (!add(Value{std::uint64_t{(*bytes)[i]}}, inner(std::to_string(i)), to)) return false;
    return true;
  }
  const auto* fields = std::get_if<Value::Fields>(&value.content);
  return fields && std::ranges::all_of(*fields, [&](const auto& field) {
           return add(field.value, inner(std::string(field.name)), to);
         });
}

constexpr std::array<std::pair<const char*, const char*>, 2> pose_parts{
    {{"position", "orientation"}, {"translation", "rotation"}}};

}  // namespace

Expected<FieldPath> FieldPath::parse(std::string_view text) {
  FieldPath made;
  made.text_ = text;
  std::string_view rest = text;
  while (!rest.empty()) {
    if (made.steps_.size() == max_steps) return no_field(text);
    if (rest.front() == '[') {
      const std::size_t close = rest.find(']');
      std::size_t place = 0;
      const char* end = rest.data() + std::min(close, rest.size());
      const auto [stop, problem] = std::from_chars(rest.data() + 1, end, place);
      if (close == std::string_view::npos || problem != std::errc() || stop != end)
        return no_field(text);
      made.steps_.emplace_back(place);
      rest.remove_prefix(close + 1);
      continue;
    }
    if (rest.front() == '.') {
      if (made.steps_.empty()) return no_field(text);
      rest.remove_prefix(1);
    } else if (!made.steps_.empty()) {
      return no_field(text);
    }
    const std::string_view name = rest.substr(0, rest.find_first_of(".["));
    if (name.empty()) return no_field(text);
    made.steps_.emplace_back(std::string(name));
    rest.remove_prefix(name.size());
  }
  return made;
}

const Value* FieldPath::in(const Value& message) const {
  return after(message, steps_.size());
}

const Value* FieldPath::holder_in(const Value& message) const {
  return steps_.empty() ? nullptr : after(message, steps_.size() - 1);
}

const Value* FieldPath::after(const Value& message, std::size_t steps) const {
  const Value* value = &message;
  for (const auto& step : std::span(steps_).first(steps)) {
    if (const auto* name = std::get_if<std::string>(&step)) {
      value = value->find(*name);
    } else {
      const auto* list = std::get_if<Value::List>(&value->content);
      const std::size_t place = std::get<std::size_t>(step);
      value = list && place < list->size() ? &(*list)[place] : nullptr;
    }
    if (!value) return nullptr;
  }
  return value;
}

std::optional<Flat> flat(const Value& value) {
  Flat made;
  if (!add(value, "", made) || made.numbers.empty() || made.numbers.size() > max_numbers)
    return std::nullopt;
  return made;
}

bool has_parts_of_pose(const Value& value) {
  return std::ranges::any_of(pose_parts, [&](const auto& parts) {
    return value.find(parts.first) && value.find(parts.second);
  });
}

std::optional<Pose> as_pose(const Value& value) {
  for (const auto& [place, turn] : pose_parts) {
    const auto p = vector(value, place);
    const Value* q = value.find(turn);
    if (!p || !q) continue;
    const auto w = number(*q, "w"), x = number(*q, "x"), y = number(*q, "y"), z = number(*q, "z");
    if (!w || !x || !y || !z) return std::nullopt;
    const auto checked = checked_pose(*p, Eigen::Quaterniond(*w, *x, *y, *z));
    return checked ? std::optional(*checked) : std::nullopt;
  }
  return std::nullopt;
}

std::optional<std::vector<std::string>> texts(const Value& value) {
  const auto* list = std::get_if<Value::List>(&value.content);
  if (!list) return std::nullopt;
  std::vector<std::string> all;
  for (const Value& each : *list) {
    const auto* text = std::get_if<std::string>(&each.content);
    if (!text) return std::nullopt;
    all.push_back(*text);
  }
  return all;
}

std::optional<std::vector<std::uint8_t>> bytes_of(const Value& value) {
  if (const auto* bytes = std::get_if<Value::Bytes>(&value.content)) return *bytes;
  const auto* text = std::get_if<std::string>(&value.content);
  return text ? from_base64(*text) : std::nullopt;
}

bool is_yes(const Value& value) {
  if (const auto* yes = std::get_if<bool>(&value.content)) return *yes;
  if (const auto* text = std::get_if<std::string>(&value.content)) return !text->empty();
  if (const auto* one = std::get_if<recording::types::Enumerator>(&value.content))
    return one->value != 0;
  const auto numbers = flat(value);
  return numbers && std::ranges::any_of(numbers->numbers, [](double x) { return x != 0; });
}

}  // namespace prehend::recorder::dataset
