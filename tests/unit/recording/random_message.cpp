#include "tests/unit/recording/random_message.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace prehend::testing {
namespace {

using namespace prehend::recording::types;

template <class Number>
Number random_number(Random& random) {
  using Limits = std::numeric_limits<Number>;
  switch (random.index(4)) {
    case 0:
      return Limits::max();
    case 1:
      return Limits::lowest();
    default:
      return static_cast<Number>(random.bits());
  }
}

Value random_one(const Type& type, Random& random) {
  switch (type.kind) {
    case Kind::boolean:
      return {random.uniform() < 0.5};
    case Kind::character:
      return {std::string(1, static_cast<char>('a' + random.index(26)))};
    case Kind::int8:
      return {std::int64_t{random_number<std::int8_t>(random)}};
    case Kind::uint8:
      return {std::uint64_t{random_number<std::uint8_t>(random)}};
    case Kind::int16:
      return {std::int64_t{random_number<std::int16_t>(random)}};
    case Kind::uint16:
      return {std::uint64_t{random_number<std::uint16_t>(random)}};
    case Kind::int32:
      return {std::int64_t{random_number<std::int32_t>(random)}};
    case Kind::uint32:
      return {std::uint64_t{random_number<std::uint32_t>(random)}};
    case Kind::int64:
      return {random_number<std::int64_t>(random)};
    case Kind::uint64:
      return {random_number<std::uint64_t>(random)};
    case Kind::float32:
      return {double{static_cast<float>(random.normal())}};
    case Kind::float64:
      return {random.normal(1e3)};
    case Kind::string: {
      const std::size_t most = type.string_bound == 0 ? 20 : std::min(type.string_bound, 40u);
      std::string text(random.index(most + 1), ' ');
      for (char& c : text) c = static_cast<char>(' ' + random.index(95));
      return {std::move(text)};
    }
    case Kind::enumeration: {
      const auto& [name, value] =
          type.enumeration->enumerators[random.index(type.enumeration->enumerators.size())];
      return {Enumerator{value, name}};
    }
    case Kind::structure:
      return random_value(*type.structure, random);
  }
  return {};
}

class Encoder {
 public:
  explicit Encoder(bool big_endian) : swap_(big_endian) {
    out = {0, static_cast<std::uint8_t>(big_endian ? 0 : 1), 0, 0};
  }

  void structure(const Structure& type, const Value& value) {
    const auto& fields = std::get<Value::Fields>(value.content);
    for (std::size_t i = 0; i < type.fields.size(); ++i)
      field(type.fields[i].type, fields[i].value);
  }

  std::vector<std::uint8_t> out;

 private:
  void field(const Type& type, const Value& value) {
    if (type.many == Type::Many::one) return one(type, value);
    if (const auto* bytes = std::get_if<Value::Bytes>(&value.content)) {
      if (type.many == Type::Many::sequence) number(static_cast<std::uint32_t>(bytes->size()));
      out.insert(out.end(), bytes->begin(), bytes->end());
      return;
    }
    const auto& list = std::get<Value::List>(value.content);
    if (type.many == Type::Many::sequence) number(static_cast<std::uint32_t>(list.size()));
    for (const Value& each : list) one(type, each);
  }

  void one(const Type& type, const Value& value) {
    const auto integer = [&]<class Number>(Number) {
      if (const auto* negative = std::get_if<std::int64_t>(&value.content))
        number(static_cast<Number>(*negative));
      else
        number(static_cast<Number>(std::get<std::uint64_t>(value.content)));
    };
    switch (type.kind) {
      case Kind::boolean:
        return number(static_cast<std::uint8_t>(std::get<bool>(value.content)));
      case Kind::character:
        return number(static_cast<std::uint8_t>(std::get<std::string>(value.content)[0]));
      case Kind::int8:
      case Kind::uint8:
        return integer(std::uint8_t{});
      case Kind::int16:
      case Kind::uint16:
        return integer(std::uint16_t{});
      case Kind::int32:
      case Kind::uint32:
        return integer(std::uint32_t{});
      case Kind::int64:
      case Kind::uint64:
        return integer(std::uint64_t{});
      case Kind::float32:
        return number(
            std::bit_cast<std::uint32_t>(static_cast<float>(std::get<double>(value.content))));
      case Kind::float64:
        return number(std::bit_cast<std::uint64_t>(std::get<double>(value.content)));
      case Kind::string: {
        const auto& text = std::get<std::string>(value.content);
        number(static_cast<std::uint32_t>(text.size() + 1));
        out.insert(out.end(), text.begin(), text.end());
        out.push_back(0);
        return;
      }
      case Kind::enumeration:
        return number(std::get<Enumerator>(value.content).value);
      case Kind::structure:
        return structure(*type.structure, value);
    }
  }

  template <class Number>
  void number(Number value) {
    while ((out.size() - 4) % sizeof value != 0) out.push_back(0);
    auto bytes = std::bit_cast<std::array<std::uint8_t, sizeof value>>(value);
    if (swap_) std::ranges::reverse(bytes);
    for (const std::uint8_t byte : bytes) out.push_back(byte);
  }

  bool swap_;
};

}  // namespace

Value random_value(const Structure& type, Random& random) {
  Value::Fields fields;
  for (const auto& [name, kind, key] : type.fields) {
    if (kind.many == Type::Many::one) {
      fields.push_back({name, random_one(kind, random)});
      continue;
    }
    const std::size_t most = kind.count == 0 ? 7 : std::min(kind.count, 7u);
    const std::size_t count = kind.many == Type::Many::array ? kind.count : random.index(most + 1);
    if (kind.kind == Kind::uint8) {
      Value::Bytes bytes(count);
      for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random.bits());
      fields.push_back({name, {std::move(bytes)}});
      continue;
    }
    Value::List list;
    for (std::size_t i = 0; i < count; ++i) list.push_back(random_one(kind, random));
    fields.push_back({name, {std::move(list)}});
  }
  return {std::move(fields)};
}

std::vector<std::uint8_t> encode(const Structure& type, const Value& value, bool big_endian) {
  Encoder encoder(big_endian);
  encoder.structure(type, value);
  return std::move(encoder.out);
}

}  // namespace prehend::testing
