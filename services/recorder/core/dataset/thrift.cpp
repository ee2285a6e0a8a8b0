#include "services/recorder/core/dataset/thrift.hpp"

namespace prehend::recorder::dataset {
namespace {

constexpr std::uint8_t type_i32 = 5, type_i64 = 6, type_list = 9, type_structure = 12,
                       type_text = 8;

}  // namespace

void ThriftWriter::varint(std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) bytes_.push_back(static_cast<std::uint8_t>(value | 0x80));
  bytes_.push_back(static_cast<std::uint8_t>(value));
}

void ThriftWriter::zigzag(std::int64_t value) {
  varint((static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63));
}

/// Fields are numbered from the one before; steps up to 15 share the byte of the type.
void ThriftWriter::head(int field, std::uint8_t type) {
  const int step = field - last_.back();
  last_.back() = field;
  if (step > 0 && step < 16) {
    bytes_.push_back(static_cast<std::uint8_t>(step << 4 | type));
    return;
  }
  bytes_.push_back(type);
  zigzag(field);
}

void ThriftWriter::integer(int field, std::int64_t value, bool wide) {
  head(field, wide ? type_i64 : type_i32);
  zigzag(value);
}

void ThriftWriter::text(int field, std::string_view value) {
  head(field, type_text);
  element_text(value);
}

void ThriftWriter::begin(int field) {
  head(field, type_structure);
  element();
}

void ThriftWriter::end() {
  bytes_.push_back(0);
  last_.pop_back();
}

void ThriftWriter::list(int field, Element element, std::size_t count) {
  head(field, type_list);
  const auto type = static_cast<std::uint8_t>(element);
  if (count < 15) {
    bytes_.push_back(static_cast<std::uint8_t>(count << 4 | type));
    return;
  }
  bytes_.push_back(static_cast<std::uint8_t>(0xf0 | type));
  varint(count);
}

void ThriftWriter::element_integer(std::int64_t value) {
  zigzag(value);
}

void ThriftWriter::element_text(std::string_view value) {
  varint(value.size());
  bytes_.insert(bytes_.end(), value.begin(), value.end());
}

}  // namespace prehend::recorder::dataset
