#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace prehend::recognition {

/// An sRGB picture, 8 bits a channel, rows from the top, pixels R G B.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;

  Picture() = default;
  Picture(int w, int h)
      : width(w), height(h), rgb(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  std::uint8_t* at(int x, int y) { return &rgb[3 * index(x, y)]; }
  const std::uint8_t* at(int x, int y) const { return &rgb[3 * index(x, y)]; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  bool empty() const { return width <= 0 || height <= 0; }
};

/// One byte a pixel: a mask (0 or 1) or palette indices.
struct Plane {
  int width = 0, height = 0;
  std::vector<std::uint8_t> values;

  Plane() = default;
  Plane(int w, int h, std::uint8_t value = 0)
      : width(w),
        height(h),
        values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), value) {}
  std::uint8_t& at(int x, int y) { return values[index(x, y)]; }
  std::uint8_t at(int x, int y) const { return values[index(x, y)]; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

/// The part of a plane in a box inside of it, so that work on a small region does not visit the
/// whole picture.
Plane crop(const Plane& plane, int left, int top, int width, int height);

}  // namespace prehend::recognition
