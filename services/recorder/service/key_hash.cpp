#include "services/recorder/service/key_hash.hpp"

#include <algorithm>
#include <bit>
#include <string>
#include <variant>
#include <vector>

#include "common/dds/release/fastdds.hpp"
#include "common/recording/types/value.hpp"

namespace prehend::recorder {
namespace {

using recording::types::Kind;

// A string without bound is taken to be no longer, as Fast DDS takes it.
constexpr std::uint32_t unbounded = 255;

std::size_t size_of(Kind kind) {
  switch (kind) {
    case Kind::boolean:
    case Kind::character:
    case Kind::int8:
    case Kind::uint8:
      return 1;
    case Kind::int16:
    case Kind::uint16:
      return 2;
    case Kind::int64:
    case Kind::uint64:
    case Kind::float64:
      return 8;
    default:
      return 4;
  }
}

std::size_t aligned(std::size_t at, std::size_t size) {
  return (at + size - 1) / size * size;
}

/// Where a field ends at the latest that begins at `at`.
std::size_t max_end(const recording::types::Type& type, std::size_t at) {
  const std::uint32_t count = type.many == recording::types::Type::Many::array ? type.count : 1;
  for (std::uint32_t i = 0; i < count; ++i) {
    at = aligned(at, size_of(type.kind)) + size_of(type.kind);
    if (type.kind == Kind::string)
      at += (type.string_bound > 0 ? type.string_bound : unbounded) + 1;
  }
  return at;
}

/// Values as big endian CDR.
class Encoder {
 public:
  void put(const recording::types::Type& type, const recording::types::Value& value) {
    if (const auto* list = std::get_if<recording::types::Value::List>(&value.content)) {
      for (const recording::types::Value& each : *list) one(type.kind, each);
    } else if (const auto* bytes = std::get_if<recording::types::Value::Bytes>(&value.content)) {
      for (const std::uint8_t byte : *bytes) number(byte, 1);
    } else {
      one(type.kind, value);
    }
  }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  void one(Kind kind, const recording::types::Value& value) {
    const auto& content = value.content;
    if (const auto* text = std::get_if<std::string>(&content)) {
      if (kind == Kind::character) return number(static_cast<std::uint8_t>(text->front()), 1);
      number(text->size() + 1, 4);
      bytes_.insert(bytes_.end(), text->begin(), text->end());
      bytes_.push_back(0);
    } else if (const auto* flag = std::get_if<bool>(&content)) {
      number(*flag ? 1 : 0, 1);
    } else if (const auto* whole = std::get_if<std::int64_t>(&content)) {
      number(static_cast<std::uint64_t>(*whole), size_of(kind));
    } else if (const auto* natural = std::get_if<std::uint64_t>(&content)) {
      number(*natural, size_of(kind));
    } else if (const auto* named = std::get_if<recording::types::Enumerator>(&content)) {
      number(named->value, 4);
    } else if (const auto* real = std::get_if<double>(&content)) {
      number(kind == Kind::float32 ? std::bit_cast<std::uint32_t>(static_cast<float>(*real))
                                   : std::bit_cast<std::uint64_t>(*real),
             size_of(kind));
    }
  }
  void number(std::uint64_t value, std::size_t size) {
    bytes_.resize(aligned(bytes_.size(), size));
    for (std::size_t i = size; i-- > 0;)
      bytes_.push_back(static_cast<std::uint8_t>(value >> 8 * i));
  }

  std::vector<std::uint8_t> bytes_;
};

}  // namespace

std::optional<KeyHash> KeyHash::of(const recording::types::Structure& type) {
  KeyHash made;
  made.head_.name = made.key_.name = type.name;
  std::size_t size = 0;
  for (const recording::types::Field& field : type.fields) {
    if (!field.key) continue;
    if (field.type.kind == Kind::structure ||
        field.type.many == recording::types::Type::Many::sequence)
      return std::nullopt;
    size = max_end(field.type, size);
    made.key_.fields.push_back(field);
    made.head_.fields.assign(type.fields.data(), &field + 1);
  }
  if (made.key_.fields.empty()) return std::nullopt;
  made.digested_ = size > 16;
  return made;
}

std::optional<dds::Guid> KeyHash::hash(const recording::types::Structure& type,
                                       std::span<const std::uint8_t> bytes) const {
  const auto value = recording::types::decode(type, bytes);
  if (!value) return std::nullopt;
  Encoder encoder;
  for (const recording::types::Field& field : key_.fields)
    encoder.put(field.type, *value->find(field.name));
  std::vector<std::uint8_t> key = encoder.bytes();
  dds::Guid guid{};
  if (digested_) {
    dds::Md5 md5;
    md5.init();
    md5.update(key.data(), static_cast<unsigned int>(key.size()));
    md5.finalize();
    std::copy_n(md5.digest, guid.size(), guid.begin());
  } else {
    std::copy_n(key.begin(), std::min(key.size(), guid.size()), guid.begin());
  }
  return guid;
}

std::optional<dds::Guid> KeyHash::of_message(std::span<const std::uint8_t> message) const {
  return hash(head_, message);
}

std::optional<dds::Guid> KeyHash::of_key(std::span<const std::uint8_t> key) const {
  return hash(key_, key);
}

}  // namespace prehend::recorder
