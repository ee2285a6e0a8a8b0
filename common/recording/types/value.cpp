#include "common/recording/types/value.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>

#include "common/base/base64.hpp"

namespace prehend::recording::types {
namespace {

class Decoder {
 public:
  /// packed: nothing is aligned, as in ROS 1.
  Decoder(std::span<const std::uint8_t> body, bool swap, bool packed)
      : body_(body), swap_(swap), packed_(packed) {}

  Expected<Value> structure(const Structure& type) {
    Value::Fields fields;
    fields.reserve(type.fields.size());
    for (const Field& field : type.fields) {
      auto value = this->field(field.type);
      if (!value) {
        std::string where = field.name;
        if (!value.error().where.empty()) where += "." + value.error().where;
        return fail(value.error().what, where);
      }
      fields.push_back({field.name, std::move(*value)});
    }
    // As in ROS 2, a structure without fields is one byte.
    if (type.fields.empty() && !packed_) (void)take(1);
    if (!good_) return fail("the message ends too early");
    return Value{std::move(fields)};
  }

 private:
  Expected<Value> field(const Type& type) {
    if (type.many == Type::Many::one) return one(type);
    const std::uint32_t count =
        type.many == Type::Many::array ? type.count : number<std::uint32_t>();
    // Every element takes at least a byte, but for structures of ROS 1 without fields.
    if (!good_ || count > body_.size() - at_) return fail("the message ends too early");
    if (type.kind == Kind::uint8) {
      const auto bytes = take(count);
      return Value{Value::Bytes(bytes.begin(), bytes.end())};
    }
    Value::List list;
    list.reserve(std::min<std::size_t>(count, 4096));
    for (std::uint32_t i = 0; i < count; ++i) {
      auto element = one(type);
      if (!element) return element;
      list.push_back(std::move(*element));
    }
    return Value{std::move(list)};
  }

  Expected<Value> one(const Type& type) {
    Value value;
    switch (type.kind) {
      case Kind::boolean:
        value.content = number<std::uint8_t>() != 0;
        break;
      case Kind::character:
        value.content = std::string(1, static_cast<char>(number<std::uint8_t>()));
        break;
      case Kind::int8:
        value.content = std::int64_t{number<std::int8_t>()};
        break;
      case Kind::uint8:
        value.content = std::uint64_t{number<std::uint8_t>()};
        break;
      case Kind::int16:
        value.content = std::int64_t{number<std::int16_t>()};
        break;
      case Kind::uint16:
        value.content = std::uint64_t{number<std::uint16_t>()};
        break;
      case Kind::int32:
        value.content = std::int64_t{number<std::int32_t>()};
        break;
      case Kind::uint32:
        value.content = std::uint64_t{number<std::uint32_t>()};
        break;
      case Kind::int64:
        value.content = number<std::int64_t>();
        break;
      case Kind::uint64:
        value.content = number<std::uint64_t>();
        break;
      case Kind::float32:
        value.content = double{std::bit_cast<float>(number<std::uint32_t>())};
        break;
      case Kind::float64:
        value.content = std::bit_cast<double>(number<std::uint64_t>());
        break;
      case Kind::string:
        value.content = string();
        break;
      case Kind::enumeration: {
        const auto raw = number<std::uint32_t>();
        value.content = Enumerator{raw, type.enumeration->name_of(raw)};
        break;
      }
      case Kind::structure:
        return structure(*type.structure);
    }
    if (!good_) return fail("the message ends too early");
    return value;
  }

  /// The length counts the closing zero, which is not part of the string.
  std::string string() {
    const auto bytes = take(number<std::uint32_t>());
    std::string text(bytes.begin(), bytes.end());
    if (!text.empty() && text.back() == '\0') text.pop_back();
    return text;
  }

  template <class Number>
  Number number() {
    if (!packed_)
      at_ = std::min((at_ + sizeof(Number) - 1) / sizeof(Number) * sizeof(Number), body_.size());
    const auto bytes = take(sizeof(Number));
    std::array<std::uint8_t, sizeof(Number)> raw{};
    std::ranges::copy(bytes, raw.begin());
    if (swap_) std::ranges::reverse(raw);
    return std::bit_cast<Number>(raw);
  }

  std::span<const std::uint8_t> take(std::size_t count) {
    if (count > body_.size() - at_) good_ = false;
    if (!good_) return {};
    const auto bytes = body_.subspan(at_, count);
    at_ += count;
    return bytes;
  }

  std::span<const std::uint8_t> body_;
  bool swap_, packed_;
  std::size_t at_ = 0;
  bool good_ = true;
};

Expected<Value> decode_body(const Structure& type, std::span<const std::uint8_t> body, bool little,
                            bool packed) {
  const bool swap = little != (std::endian::native == std::endian::little);
  auto value = Decoder(body, swap, packed).structure(type);
  if (!value)
    return fail(value.error().what,
                type.name + (value.error().where.empty() ? "" : "." + value.error().where));
  return value;
}

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

}  // namespace

const Value* Value::find(std::string_view field) const {
  const Fields* fields = std::get_if<Fields>(&content);
  if (!fields) return nullptr;
  const auto found = std::ranges::find(*fields, field, &NamedValue::name);
  return found == fields->end() ? nullptr : &found->value;
}

Expected<Value> decode(const Structure& type, std::span<const std::uint8_t> message) {
  if (message.size() < 4) return fail("a message without encapsulation", type.name);
  // 0: CDR big endian, 1: CDR little endian
  if (message[0] != 0 || message[1] > 1)
    return fail("an encapsulation other than plain CDR", type.name);
  const bool little = message[1] == 1;
  return decode_body(type, message.subspan(4), little, false);
}

Expected<Value> decode_ros1(const Structure& type, std::span<const std::uint8_t> message) {
  return decode_body(type, message, true, true);
}

nlohmann::ordered_json to_json(const Value& value) {
  using Json = nlohmann::ordered_json;
  return std::visit(
      Overloaded{[](const Enumerator& e) { return e.name.empty() ? Json(e.value) : Json(e.name); },
                 [](const Value::Bytes& bytes) { return Json(base64(bytes)); },
                 [](const Value::List& list) {
                   Json array = Json::array();
                   for (const Value& each : list) array.push_back(to_json(each));
                   return array;
                 },
                 [](const Value::Fields& fields) {
                   Json object = Json::object();
                   for (const auto& [name, each] : fields)
                     object[std::string(name)] = to_json(each);
                   return object;
                 },
                 [](const auto& plain) { return Json(plain); }},
      value.content);
}

}  // namespace prehend::recording::types
