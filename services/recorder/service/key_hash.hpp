#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/dds/raw.hpp"
#include "common/recording/types/type.hpp"

namespace prehend::recorder {

/// The instance that a message belongs to, from its key fields: what DDS writers may send beside a
/// message and not all do (DDSI-RTPS 2.5, 9.6.4.8). The key fields as big endian CDR, filled up
/// with zeros, or, when that can be longer than 16 bytes, its MD5.
class KeyHash {
 public:
  /// Nothing for types without key and for keys with sequences or structures in them.
  static std::optional<KeyHash> of(const recording::types::Structure& type);

  /// Of a message with its encapsulation; nothing when it ends too early.
  std::optional<dds::Guid> of_message(std::span<const std::uint8_t> message) const;
  /// Of the key fields alone, as writers send them with the end of an instance.
  std::optional<dds::Guid> of_key(std::span<const std::uint8_t> key) const;

 private:
  KeyHash() = default;
  std::optional<dds::Guid> hash(const recording::types::Structure& type,
                                std::span<const std::uint8_t> bytes) const;

  recording::types::Structure head_, key_;  // the type up to its last key field, and its key fields
  bool digested_ = false;
};

}  // namespace prehend::recorder
