#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/base/error.hpp"
#include "common/recording/types/type.hpp"

namespace prehend::recording::types {

/// An enumerator; its name is empty where the type has none for the value.
struct Enumerator {
  std::uint32_t value = 0;
  std::string_view name;
};

struct NamedValue;

/// A message, or a part of one, in memory. Names belong to the type it was decoded by.
struct Value {
  using Bytes = std::vector<std::uint8_t>;  // arrays and sequences of octets
  using List = std::vector<Value>;
  using Fields = std::vector<NamedValue>;

  std::variant<bool, std::int64_t, std::uint64_t, double, std::string, Enumerator, Bytes, List,
               Fields>
      content;

  /// The field of a structure; nothing when there is none.
  const Value* find(std::string_view field) const;
};

struct NamedValue {
  std::string_view name;
  Value value;
};

/// Decodes XCDR1 of final structures as Fast DDS and ROS 2 write it, either byte order, from the
/// four bytes of encapsulation on. Bytes behind the last field are passed by. Fails on data that
/// end early and names the field; lengths are checked before memory is taken.
Expected<Value> decode(const Structure& type, std::span<const std::uint8_t> message);

/// The same of ROS 1: little endian, without encapsulation and without padding.
Expected<Value> decode_ros1(const Structure& type, std::span<const std::uint8_t> message);

/// Numbers as numbers, enumerators by name, bytes as base64; not-a-number and infinities are null.
nlohmann::ordered_json to_json(const Value& value);

}  // namespace prehend::recording::types
