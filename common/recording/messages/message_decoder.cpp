#include "common/recording/messages/message_decoder.hpp"

#include "common/base/printable.hpp"

namespace prehend::recording {

using types::Value;

Expected<Value> MessageDecoder::decode(const mcap::Channel& channel,
                                       std::span<const std::uint8_t> message) {
  const std::string& encoding = channel.message_encoding;
  Expected<Value> value = fail("only CDR, ROS 1, JSON and protobuf are read");
  if (encoding == "json") {
    value = json_message(message, names_);
  } else if (encoding == "protobuf") {
    value = decode_protobuf(channel, message);
  } else if (encoding == "cdr" || encoding == "ros1") {
    const types::Structure* type = type_of(channel);
    value = !type               ? fail("its type is not described")
            : encoding == "cdr" ? types::decode(*type, message)
                                : types::decode_ros1(*type, message);
  }
  if (value) return value;
  return fail(value.error().what + ", " + described(channel), value.error().where);
}

Expected<Value> MessageDecoder::decode_protobuf(const mcap::Channel& channel,
                                                std::span<const std::uint8_t> message) {
  const auto schema = reader_.contents().schemas.find(channel.schema_id);
  if (schema == reader_.contents().schemas.end() || schema->second.encoding != "protobuf")
    return fail("its type is not described");
  auto known = protobuf_.find(channel.schema_id);
  if (known == protobuf_.end())
    known = protobuf_
                .emplace(channel.schema_id,
                         ProtobufType::create(schema->second.data, schema->second.name))
                .first;
  if (!known->second) return tl::unexpected(known->second.error());
  return (*known->second)->decode(message);
}

std::string MessageDecoder::described(const mcap::Channel& channel) const {
  const auto schema = reader_.contents().schemas.find(channel.schema_id);
  std::string text = "encoding «" + printable(channel.message_encoding) + "», ";
  if (schema == reader_.contents().schemas.end()) return text + "without a schema";
  return text + "schema " + printable(schema->second.name) + " (" +
         printable(schema->second.encoding) + ")";
}

}  // namespace prehend::recording
