#include "services/recorder/core/dataset/parquet.hpp"

#include <algorithm>
#include <cstring>
#include <functional>
#include <string_view>

#include "services/recorder/core/dataset/thrift.hpp"

// Numbers are those of the format's parquet.thrift.
namespace prehend::recorder::dataset {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::string_view magic = "PAR1";
constexpr int encoding_plain = 0, encoding_rle = 3;
constexpr int repetition_optional = 1, repetition_repeated = 2;
constexpr int converted_text = 0, converted_list = 3;

void append(Bytes& to, const void* from, std::size_t size) {
  const auto* first = static_cast<const std::uint8_t*>(from);
  to.insert(to.end(), first, first + size);
}

void append_length(Bytes& to, std::size_t length) {
  for (int shift = 0; shift < 32; shift += 8)
    to.push_back(static_cast<std::uint8_t>(length >> shift));
}

/// Plain encoding. Machines that we run on are little-endian, as the format is.
struct Plain {
  Bytes operator()(const std::vector<bool>& values) const {
    Bytes bytes((values.size() + 7) / 8);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (values[i]) bytes[i / 8] = static_cast<std::uint8_t>(bytes[i / 8] | 1 << (i % 8));
    return bytes;
  }
  template <class Number>
  Bytes operator()(const std::vector<Number>& values) const {
    Bytes bytes;
    append(bytes, values.data(), values.size() * sizeof(Number));
    return bytes;
  }
  Bytes operator()(const std::vector<std::string>& values) const {
    Bytes bytes;
    for (const std::string& value : values) {
      append_length(bytes, value.size());
      append(bytes, value.data(), value.size());
    }
    return bytes;
  }
};

int physical_type(const Column& column) {
  constexpr int types[] = {0, 2, 4, 5, 6};  // boolean, int64, float, double, byte array
  return types[column.values.index()];
}
bool is_text(const Column& column) {
  return std::holds_alternative<std::vector<std::string>>(column.values);
}

/// How often the list at each depth begins anew: 0 where a row begins, d where only the innermost
/// list of d goes on.
std::size_t repetition_level(const std::vector<std::size_t>& shape, std::size_t index) {
  std::size_t block = 1;
  for (const std::size_t extent : shape) block *= extent;
  std::size_t level = 0;
  while (level < shape.size() && index % block != 0) block /= shape[level++];
  return level;
}

int bits_of(std::size_t max_level) {
  int bits = 0;
  for (; max_level > 0; max_level >>= 1) ++bits;
  return bits;
}

void append_varint(Bytes& to, std::size_t value) {
  for (; value >= 0x80; value >>= 7) to.push_back(static_cast<std::uint8_t>(value | 0x80));
  to.push_back(static_cast<std::uint8_t>(value));
}

/// Levels in the hybrid encoding, behind their length: one bit-packed run.
void append_packed(Bytes& page, std::size_t count, std::size_t max_level,
                   const std::function<std::size_t(std::size_t)>& level) {
  const int bits = bits_of(max_level);
  const std::size_t groups = (count + 7) / 8;
  Bytes run;
  append_varint(run, groups << 1 | 1);
  unsigned pending = 0;
  int filled = 0;
  for (std::size_t i = 0; i < groups * 8; ++i) {
    pending |= static_cast<unsigned>(i < count ? level(i) : 0) << filled;
    for (filled += bits; filled >= 8; filled -= 8, pending >>= 8)
      run.push_back(static_cast<std::uint8_t>(pending));
  }
  append_length(page, run.size());
  append(page, run.data(), run.size());
}

/// The same of a level that never changes: one repeated run.
void append_repeated(Bytes& page, std::size_t count, std::size_t level) {
  Bytes run;
  append_varint(run, count << 1);
  run.push_back(static_cast<std::uint8_t>(level));
  append_length(page, run.size());
  append(page, run.data(), run.size());
}

/// Each depth of a list is optional itself, and so are its elements.
std::size_t max_definition(const Column& column) {
  return 1 + 2 * column.shape.size();
}

Bytes page_of(const Column& column) {
  const std::size_t count = column.count();
  Bytes body;
  if (!column.shape.empty())
    append_packed(body, count, column.shape.size(),
                  [&](std::size_t i) { return repetition_level(column.shape, i); });
  append_repeated(body, count, max_definition(column));
  const Bytes plain = std::visit(Plain{}, column.values);
  append(body, plain.data(), plain.size());

  ThriftWriter head;
  const auto size = static_cast<std::int64_t>(body.size());
  head.integer(1, 0);  // a data page
  head.integer(2, size);
  head.integer(3, size);
  head.begin(5);
  head.integer(1, static_cast<std::int64_t>(count));
  head.integer(2, encoding_plain);
  head.integer(3, encoding_rle);
  head.integer(4, encoding_rle);
  head.end();
  head.end();
  Bytes page = head.bytes();
  append(page, body.data(), body.size());
  return page;
}

/// A group, or where it has a type, a leaf.
void write_element(ThriftWriter& footer, const std::string& name, int repetition, int type,
                   int children, int converted) {
  footer.element();
  if (type >= 0) footer.integer(1, type);
  if (repetition >= 0) footer.integer(3, repetition);
  footer.text(4, name);
  if (children > 0) footer.integer(5, children);
  if (converted >= 0) footer.integer(6, converted);
  footer.end();
}

void write_schema(ThriftWriter& footer, const std::vector<Column>& columns) {
  std::size_t elements = 1;
  for (const Column& column : columns) elements += 1 + 2 * column.shape.size();
  footer.list(2, ThriftWriter::Element::structure, elements);
  write_element(footer, "schema", -1, -1, static_cast<int>(columns.size()), -1);
  for (const Column& column : columns) {
    std::string name = column.name;
    for (std::size_t depth = 0; depth < column.shape.size(); ++depth) {
      write_element(footer, name, repetition_optional, -1, 1, converted_list);
      write_element(footer, "list", repetition_repeated, -1, 1, -1);
      name = "element";
    }
    write_element(footer, name, repetition_optional, physical_type(column), 0,
                  is_text(column) ? converted_text : -1);
  }
}

void write_chunk(ThriftWriter& footer, const Column& column, std::size_t offset, std::size_t size) {
  footer.element();
  footer.integer(2, static_cast<std::int64_t>(offset), true);
  footer.begin(3);
  footer.integer(1, physical_type(column));
  footer.list(2, ThriftWriter::Element::integer, 2);
  footer.element_integer(encoding_plain);
  footer.element_integer(encoding_rle);
  footer.list(3, ThriftWriter::Element::text, 1 + 2 * column.shape.size());
  footer.element_text(column.name);
  for (std::size_t depth = 0; depth < column.shape.size(); ++depth) {
    footer.element_text("list");
    footer.element_text("element");
  }
  footer.integer(4, 0);  // not compressed
  footer.integer(5, static_cast<std::int64_t>(column.count()), true);
  footer.integer(6, static_cast<std::int64_t>(size), true);
  footer.integer(7, static_cast<std::int64_t>(size), true);
  footer.integer(9, static_cast<std::int64_t>(offset), true);
  footer.end();
  footer.end();
}

}  // namespace

std::size_t Column::count() const {
  return std::visit([](const auto& all) { return all.size(); }, values);
}

Bytes parquet(const std::vector<Column>& columns, std::size_t rows,
              const std::vector<std::pair<std::string, std::string>>& metadata) {
  Bytes file(magic.begin(), magic.end());
  std::vector<std::size_t> offsets;
  for (const Column& column : columns) {
    offsets.push_back(file.size());
    const Bytes page = page_of(column);
    append(file, page.data(), page.size());
  }
  offsets.push_back(file.size());

  ThriftWriter footer;
  footer.integer(1, 1);  // version
  write_schema(footer, columns);
  footer.integer(3, static_cast<std::int64_t>(rows), true);
  footer.list(4, ThriftWriter::Element::structure, 1);
  footer.element();
  footer.list(1, ThriftWriter::Element::structure, columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i)
    write_chunk(footer, columns[i], offsets[i], offsets[i + 1] - offsets[i]);
  footer.integer(2, static_cast<std::int64_t>(file.size() - magic.size()), true);
  footer.integer(3, static_cast<std::int64_t>(rows), true);
  footer.end();
  if (!metadata.empty()) {
    footer.list(5, ThriftWriter::Element::structure, metadata.size());
    for (const auto& [key, value] : metadata) {
      footer.element();
      footer.text(1, key);
      footer.text(2, value);
      footer.end();
    }
  }
  footer.text(6, "prehend");
  footer.end();
  append(file, footer.bytes().data(), footer.bytes().size());
  append_length(file, footer.bytes().size());
  append(file, magic.data(), magic.size());
  return file;
}

}  // namespace prehend::recorder::dataset
