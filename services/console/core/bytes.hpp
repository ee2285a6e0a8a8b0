#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace prehend::console {

/// Reads numbers of a binary message, little endian. What is not there fails all that follows.
class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : rest_(bytes) {}

  template <class Number>
  Number number() {
    Number made = 0;
    if (rest_.size() < sizeof made) {
      good_ = false;
      return 0;
    }
    for (std::size_t i = 0; i < sizeof made; ++i)
      made |= static_cast<Number>(Number{static_cast<unsigned char>(rest_[i])} << (8 * i));
    rest_.remove_prefix(sizeof made);
    return made;
  }
  /// A text behind its size; a longer one than `most` is none.
  std::string text(std::size_t most) {
    const auto size = number<std::uint32_t>();
    if (!good_ || size > most || size > rest_.size()) {
      good_ = false;
      return {};
    }
    std::string made(rest_.substr(0, size));
    rest_.remove_prefix(size);
    return made;
  }
  std::string_view rest() const { return rest_; }
  bool good() const { return good_; }

 private:
  std::string_view rest_;
  bool good_ = true;
};

/// Adds a number, little endian.
template <class Number>
void put_number(std::string& bytes, Number value) {
  for (std::size_t i = 0; i < sizeof value; ++i)
    bytes += static_cast<char>(value >> (8 * i) & 0xffU);
}

}  // namespace prehend::console
