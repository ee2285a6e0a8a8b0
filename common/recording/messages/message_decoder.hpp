#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "common/recording/compare/recorded_topic.hpp"
#include "common/recording/mcap/reader.hpp"
#include "common/recording/messages/json_message.hpp"
#include "common/recording/messages/protobuf_type.hpp"

namespace prehend::recording {

/// Decodes the messages of anybody's recording, as far as the recording describes them: CDR by IDL
/// (omgidl, ros2idl) or ros2msg, ROS 1 by ros1msg, protobuf by its descriptors, JSON by itself.
class MessageDecoder {
 public:
  /// The reader must outlive it.
  explicit MessageDecoder(const mcap::Reader& reader) : reader_(reader), types_(reader) {}

  /// The type of CDR or of ROS 1; nothing of what has none, or is not described in a way that we
  /// read. Lives as long as this.
  const types::Structure* type_of(const mcap::Channel& channel) {
    return channel.message_encoding == "ros1" ? types_.of_ros1(channel) : types_.of(channel);
  }

  /// Names of fields live as long as this. The error says how it is encoded and described, where
  /// that is why.
  Expected<types::Value> decode(const mcap::Channel& channel,
                                std::span<const std::uint8_t> message);

 private:
  Expected<types::Value> decode_protobuf(const mcap::Channel& channel,
                                         std::span<const std::uint8_t> message);
  std::string described(const mcap::Channel& channel) const;

  const mcap::Reader& reader_;
  RecordedTypes types_;
  Names names_;
  std::map<std::uint16_t, Expected<std::unique_ptr<ProtobufType>>> protobuf_;  // by schema
};

}  // namespace prehend::recording
