#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace prehend::recording::mcap {

using Bytes = std::vector<std::uint8_t>;
using View = std::span<const std::uint8_t>;

static_assert(std::endian::native == std::endian::little,
              "numbers are copied as they lie in memory");

inline View view(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}
inline std::string_view text(View bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Not insert(): in that GCC 12 sees an overflow where there is none.
inline void append(Bytes& out, View bytes) {
  const std::size_t at = out.size();
  out.resize(at + bytes.size());
  if (!bytes.empty()) std::memcpy(out.data() + at, bytes.data(), bytes.size());
}
template <class Number>
requires std::is_integral_v<Number>
void append(Bytes& out, Number number) {
  append(out, View(reinterpret_cast<const std::uint8_t*>(&number), sizeof number));
}
/// Length of 32 bits, then the characters.
inline void append_string(Bytes& out, std::string_view string) {
  append(out, static_cast<std::uint32_t>(string.size()));
  append(out, view(string));
}
template <class Number>
void overwrite(Bytes& out, std::size_t at, Number number) {
  std::memcpy(out.data() + at, &number, sizeof number);
}

/// Takes fields from the front of a view. Past the end every field reads as zero or empty, and
/// `good()` says so once and for all: a caller checks once, after the last field.
class Cursor {
 public:
  explicit Cursor(View bytes) : rest_(bytes) {}

  template <class Number>
  Number number() {
    Number value{};
    const View bytes = take(sizeof value);
    if (good_) std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  View take(std::uint64_t count) {
    if (count > rest_.size()) good_ = false;
    if (!good_) return {};
    const View front = rest_.first(count);
    rest_ = rest_.subspan(count);
    return front;
  }
  std::string string() { return std::string(text(take(number<std::uint32_t>()))); }

  View rest() const { return rest_; }
  bool good() const { return good_; }
  bool more() const { return good_ && !rest_.empty(); }

 private:
  View rest_;
  bool good_ = true;
};

}  // namespace prehend::recording::mcap
