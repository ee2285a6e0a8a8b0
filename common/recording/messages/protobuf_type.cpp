#include "common/recording/messages/protobuf_type.hpp"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/descriptor_database.h>
#include <google/protobuf/dynamic_message.h>

#include <utility>

namespace prehend::recording {
namespace {

namespace pb = google::protobuf;
using types::Value;

/// Says nothing: whoever asked is told that it failed.
class Silence final : public pb::DescriptorPool::ErrorCollector {
 public:
  void AddError(const std::string&, const std::string&, const pb::Message*, ErrorLocation,
                const std::string&) override {}
};

Value enumerator(const pb::EnumValueDescriptor& one) {
  return {types::Enumerator{static_cast<std::uint32_t>(one.number()), one.name()}};
}

Value text_or_bytes(const pb::FieldDescriptor& field, std::string text) {
  if (field.type() == pb::FieldDescriptor::TYPE_BYTES)
    return {Value::Bytes(text.begin(), text.end())};
  return {std::move(text)};
}

/// A message as values; its parser has bounded how deep it lies inside itself.
class Walk {
 public:
  Value message(const pb::Message& message) {
    Value::Fields fields;
    const pb::Descriptor& type = *message.GetDescriptor();
    const pb::Reflection& see = *message.GetReflection();
    for (int i = 0; i < type.field_count(); ++i) {
      const pb::FieldDescriptor& field = *type.field(i);
      if (field.is_repeated()) {
        Value::List list;
        const int count = see.FieldSize(message, &field);
        list.reserve(static_cast<std::size_t>(count));
        for (int k = 0; k < count; ++k) list.push_back(element(message, see, field, k));
        fields.push_back({field.name(), {std::move(list)}});
      } else if (!field.has_presence() || see.HasField(message, &field) ||
                 field.cpp_type() != pb::FieldDescriptor::CPPTYPE_MESSAGE) {
        fields.push_back({field.name(), one(message, see, field)});
      }
    }
    return {std::move(fields)};
  }

 private:
  Value one(const pb::Message& message, const pb::Reflection& see,
            const pb::FieldDescriptor& field) {
    switch (field.cpp_type()) {
      case pb::FieldDescriptor::CPPTYPE_INT32:
        return {std::int64_t{see.GetInt32(message, &field)}};
      case pb::FieldDescriptor::CPPTYPE_INT64:
        return {std::int64_t{see.GetInt64(message, &field)}};
      case pb::FieldDescriptor::CPPTYPE_UINT32:
        return {std::uint64_t{see.GetUInt32(message, &field)}};
      case pb::FieldDescriptor::CPPTYPE_UINT64:
        return {std::uint64_t{see.GetUInt64(message, &field)}};
      case pb::FieldDescriptor::CPPTYPE_DOUBLE:
        return {see.GetDouble(message, &field)};
      case pb::FieldDescriptor::CPPTYPE_FLOAT:
        return {double{see.GetFloat(message, &field)}};
      case pb::FieldDescriptor::CPPTYPE_BOOL:
        return {see.GetBool(message, &field)};
      case pb::FieldDescriptor::CPPTYPE_ENUM:
        return enumerator(*see.GetEnum(message, &field));
      case pb::FieldDescriptor::CPPTYPE_STRING:
        return text_or_bytes(field, see.GetString(message, &field));
      case pb::FieldDescriptor::CPPTYPE_MESSAGE:
        return this->message(see.GetMessage(message, &field));
    }
    return {std::string()};
  }

  Value element(const pb::Message& message, const pb::Reflection& see,
                const pb::FieldDescriptor& field, int k) {
    switch (field.cpp_type()) {
      case pb::FieldDescriptor::CPPTYPE_INT32:
        return {std::int64_t{see.GetRepeatedInt32(message, &field, k)}};
      case pb::FieldDescriptor::CPPTYPE_INT64:
        return {std::int64_t{see.GetRepeatedInt64(message, &field, k)}};
      case pb::FieldDescriptor::CPPTYPE_UINT32:
        return {std::uint64_t{see.GetRepeatedUInt32(message, &field, k)}};
      case pb::FieldDescriptor::CPPTYPE_UINT64:
        return {std::uint64_t{see.GetRepeatedUInt64(message, &field, k)}};
      case pb::FieldDescriptor::CPPTYPE_DOUBLE:
        return {see.GetRepeatedDouble(message, &field, k)};
      case pb::FieldDescriptor::CPPTYPE_FLOAT:
        return {double{see.GetRepeatedFloat(message, &field, k)}};
      case pb::FieldDescriptor::CPPTYPE_BOOL:
        return {see.GetRepeatedBool(message, &field, k)};
      case pb::FieldDescriptor::CPPTYPE_ENUM:
        return enumerator(*see.GetRepeatedEnum(message, &field, k));
      case pb::FieldDescriptor::CPPTYPE_STRING:
        return text_or_bytes(field, see.GetRepeatedString(message, &field, k));
      case pb::FieldDescriptor::CPPTYPE_MESSAGE:
        return this->message(see.GetRepeatedMessage(message, &field, k));
    }
    return {std::string()};
  }
};

}  // namespace

struct ProtobufType::Parts {
  Silence silence;
  pb::SimpleDescriptorDatabase files;
  pb::DescriptorPool pool{&files, &silence};
  pb::DynamicMessageFactory factory{&pool};
  const pb::Message* prototype = nullptr;  // owned by the factory
};

ProtobufType::ProtobufType(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
ProtobufType::~ProtobufType() = default;

Expected<std::unique_ptr<ProtobufType>> ProtobufType::create(std::string_view descriptors,
                                                             const std::string& name) {
  pb::FileDescriptorSet set;
  if (!set.ParseFromArray(descriptors.data(), static_cast<int>(descriptors.size())))
    return fail("its description is no FileDescriptorSet");
  auto parts = std::make_unique<Parts>();
  for (const pb::FileDescriptorProto& file : set.file())
    if (!parts->files.Add(file)) return fail("its description says a part of it twice");
  const pb::Descriptor* type = parts->pool.FindMessageTypeByName(name);
  if (!type) return fail("its type is not in its description, or lacks a part");
  parts->prototype = parts->factory.GetPrototype(type);
  return std::unique_ptr<ProtobufType>(new ProtobufType(std::move(parts)));
}

Expected<Value> ProtobufType::decode(std::span<const std::uint8_t> message) const {
  const std::unique_ptr<pb::Message> made(parts_->prototype->New());
  if (!made->ParsePartialFromArray(message.data(), static_cast<int>(message.size())))
    return fail("it is no message of its type");
  return Walk().message(*made);
}

}  // namespace prehend::recording
