#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/recording/types/value.hpp"

namespace prehend::recording {

/// A message type that is known only by its description, a FileDescriptorSet.
class ProtobufType {
 public:
  /// name: with its package. Fails on a description that is damaged or lacks a part.
  static Expected<std::unique_ptr<ProtobufType>> create(std::string_view descriptors,
                                                        const std::string& name);
  ~ProtobufType();
  ProtobufType(const ProtobufType&) = delete;
  ProtobufType& operator=(const ProtobufType&) = delete;

  /// Numbers, texts and enumerators that were not written have their defaults; messages that were
  /// not are not there. Names live as long as this does.
  Expected<types::Value> decode(std::span<const std::uint8_t> message) const;

 private:
  struct Parts;
  explicit ProtobufType(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace prehend::recording
