#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace prehend::recorder::dataset {

/// Writes structures in Thrift's compact protocol, as far as Parquet's metadata need it: fields in
/// order of their numbers, of integers, text, structures, and lists of these.
class ThriftWriter {
 public:
  void integer(int field, std::int64_t value, bool wide = false);  // i32, or i64
  void text(int field, std::string_view value);
  void begin(int field);  // a structure
  void end();             // of a structure; of the whole, too

  /// What follows are so many elements: each an element_integer(), element_text(), or a structure
  /// between element() and end().
  enum class Element : std::uint8_t { integer = 5, text = 8, structure = 12 };
  void list(int field, Element element, std::size_t count);
  void element_integer(std::int64_t value);
  void element_text(std::string_view value);
  void element() { last_.push_back(0); }

  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  void head(int field, std::uint8_t type);
  void varint(std::uint64_t value);
  void zigzag(std::int64_t value);

  std::vector<std::uint8_t> bytes_;
  std::vector<int> last_{0};  // field of each structure that is open
};

}  // namespace prehend::recorder::dataset
