#include "services/recognition/core/rendering/texture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/random.hpp"

namespace prehend::recognition {
namespace {

constexpr double texel = 0.001;  // m; a camera at 1 m sees about two of them in a pixel

using Colour = Eigen::Vector3f;

/// Paints in metres from the lower left corner. `wrap`: the left edge touches the right one.
class Canvas {
 public:
  Canvas(double width, double height, const Colour& colour, bool wrap)
      : width_(width), height_(height), wrap_(wrap) {
    face_.width = std::max(1, static_cast<int>(std::lround(width / texel)));
    face_.height = std::max(1, static_cast<int>(std::lround(height / texel)));
    face_.albedo.assign(
        static_cast<std::size_t>(face_.width) * static_cast<std::size_t>(face_.height), colour);
  }
  void rectangle(double x, double y, double w, double h, const Colour& colour) {
    paint(
        [&](double u, double v) {
          const double du = from(u, x);
          return du >= 0 && du < w && v >= y && v < y + h;
        },
        colour);
  }
  void ellipse(double x, double y, double rx, double ry, const Colour& colour) {
    paint(
        [&](double u, double v) {
          double du = u - x;
          if (wrap_) du = std::remainder(du, width_);
          return du * du / (rx * rx) + (v - y) * (v - y) / (ry * ry) < 1;
        },
        colour);
  }
  /// Lines of short strokes of uneven length, as print looks from a metre away.
  void print(double x, double y, double w, double h, double line, const Colour& colour,
             Random& random) {
    for (double v = y + h - line; v >= y; v -= 1.8 * line)
      for (double u = x; u < x + w;) {
        const double length = std::min(random.uniform(0.8, 3.5) * line, x + w - u);
        rectangle(u, v, length, line, colour);
        u += length + 0.7 * line;
      }
  }
  /// Fine unevenness of the material, the same in all channels.
  void grain(double strength, double across, double along, std::uint64_t seed) {
    for (int j = 0; j < face_.height; ++j)
      for (int i = 0; i < face_.width; ++i)
        pixel(i, j) *= static_cast<float>(
            1 + strength * value_noise(i * texel / across, j * texel / along, seed));
  }
  double width() const { return width_; }
  double height() const { return height_; }
  Face take() { return std::move(face_); }

 private:
  double from(double u, double x) const {
    const double du = u - x;
    return wrap_ ? du - width_ * std::floor(du / width_) : du;
  }
  Colour& pixel(int i, int j) {
    return face_.albedo[static_cast<std::size_t>(j) * static_cast<std::size_t>(face_.width) +
                        static_cast<std::size_t>(i)];
  }
  template <class Inside>
  void paint(Inside inside, const Colour& colour) {
    for (int j = 0; j < face_.height; ++j)
      for (int i = 0; i < face_.width; ++i)
        if (inside((i + 0.5) * texel, (j + 0.5) * texel)) pixel(i, j) = colour;
  }

  double width_, height_;
  bool wrap_;
  Face face_;
};

/// The printed or moulded side of an object.
void decorate(Canvas& side, const std::string& pattern, const std::vector<Colour>& colours,
              bool wrap, Random& random) {
  const auto colour = [&](std::size_t i) { return colours[std::min(i, colours.size() - 1)]; };
  const double w = side.width(), h = side.height();
  if (pattern == "bands") {
    const double first = random.uniform(0.30, 0.40), thick = random.uniform(0.24, 0.30);
    side.rectangle(0, first * h, w, thick * h, colour(1));
    side.rectangle(0, (first + thick + 0.06) * h, w, 0.05 * h, colour(2));
    side.rectangle(0, 0, w, 0.07 * h, colour(2));
    const int dots = std::max(2, static_cast<int>(w / 0.04));
    for (int i = 0; i < dots; ++i)
      side.ellipse((i + 0.5) * w / dots, 0.17 * h, 0.008, 0.008, colour(3));
  } else if (pattern == "checks") {  // a packing case: tape, a sticker, stamped print
    side.rectangle(0, 0.44 * h, w, 0.13 * h, colour(1));
    const double x = random.uniform(0.05, 0.5) * w;
    side.rectangle(x, 0.62 * h, 0.32 * w, 0.28 * h, colour(3));
    side.print(x + 0.02 * w, 0.65 * h, 0.26 * w, 0.22 * h, 0.004, colour(2), random);
    const double cell = 0.012, left = random.uniform(0.1, 0.6) * w;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 3; ++j)
        if ((i + j) % 2 == 0)
          side.rectangle(left + i * cell, 0.08 * h + j * cell, cell, cell, colour(2));
  } else if (pattern == "blobs") {
    const double area = w * h;
    const int count = std::clamp(static_cast<int>(area / 2.5e-4), 3, 60);
    for (int i = 0; i < count; ++i) {
      const double r = random.uniform(0.002, 0.0045);
      side.ellipse(random.uniform(0, w), random.uniform(0, h), r * random.uniform(1.0, 2.2), r,
                   colour(1 + random.index(2)));
    }
    side.rectangle(0.32 * w, 0.2 * h, 0.12 * w, 0.6 * h, colour(2));  // a letter
    side.rectangle(0.32 * w, 0.2 * h, 0.36 * w, 0.12 * h, colour(2));
  } else if (pattern == "label") {
    // The labels repeat around a can, so that some print shows from every side.
    const int labels = wrap ? 2 : 1;
    side.rectangle(0, 0.90 * h, w, 0.10 * h, colour(3));  // lid or upper stripe
    side.rectangle(0, 0, w, 0.05 * h, colour(2));
    for (int i = 0; i < labels; ++i) {
      const double lw = w / labels, x = i * lw + 0.08 * lw;
      side.rectangle(x, 0.16 * h, 0.84 * lw, 0.5 * h, colour(1));
      side.ellipse(x + 0.42 * lw, 0.68 * h, 0.33 * lw, std::min(0.16 * h, 0.33 * lw), colour(2));
      side.ellipse(x + 0.42 * lw, 0.68 * h, 0.22 * lw, std::min(0.1 * h, 0.22 * lw), colour(3));
      const double line = std::max(0.003, 0.028 * h);
      side.print(x + 0.08 * lw, 0.2 * h, 0.68 * lw, 0.28 * h, line, colour(2), random);
    }
  }
}

std::uint64_t mix(std::uint64_t z) {  // splitmix64
  z += 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

double lattice(std::int64_t x, std::int64_t y, std::uint64_t seed) {
  const auto key = static_cast<std::uint64_t>(x) * 0x8da6b343ull ^
                   static_cast<std::uint64_t>(y) * 0xd8163841ull ^ seed;
  return static_cast<double>(mix(key) >> 11) * 0x1.0p-52 - 1.0;
}

}  // namespace

const Eigen::Vector3f& Face::at(double u, double v) const {
  const int i = std::clamp(static_cast<int>(u * width), 0, width - 1);
  const int j = std::clamp(static_cast<int>(v * height), 0, height - 1);
  return albedo[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(i)];
}

float to_linear(float c) {
  return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

float to_srgb(float c) {
  return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
}

double value_noise(double x, double y, std::uint64_t seed) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto i = static_cast<std::int64_t>(fx), j = static_cast<std::int64_t>(fy);
  double u = x - fx, v = y - fy;
  u = u * u * (3 - 2 * u);
  v = v * v * (3 - 2 * v);
  const double low = lattice(i, j, seed) * (1 - u) + lattice(i + 1, j, seed) * u;
  const double high = lattice(i, j + 1, seed) * (1 - u) + lattice(i + 1, j + 1, seed) * u;
  return low * (1 - v) + high * v;
}

Texture paint(const model::CatalogueObject& object) {
  std::vector<Colour> colours;
  for (const Eigen::Vector3d& c : object.appearance.colours)
    colours.push_back(c.cast<float>().cwiseMax(0.f).cwiseMin(1.f).unaryExpr(&to_linear));
  if (colours.empty()) colours.push_back(Colour::Constant(0.5f));
  Random random(object.appearance.seed);
  const bool wooden = object.material == "wood";
  const Eigen::Vector3d half = model::half_extents(object.shape);
  Texture made;
  const auto add = [&](double w, double h, bool wrap, bool top) {
    Canvas canvas(w, h, colours.front(), wrap);
    const std::string& pattern = object.appearance.pattern;
    if (!top)
      decorate(canvas, pattern, colours, wrap, random);
    else if (pattern == "blobs" || pattern == "checks")
      decorate(canvas, pattern, colours, false, random);
    else if (colours.size() > 1)  // a lid, or the flap of a box
      canvas.rectangle(0.12 * w, 0.12 * h, 0.76 * w, 0.76 * h, colours.back());
    canvas.grain(wooden ? 0.10 : 0.03, wooden ? 0.02 : 0.006, 0.006, random.bits());
    made.faces.push_back(canvas.take());
  };
  if (object.shape.kind == model::ShapeKind::box) {
    for (int side = 0; side < 4; ++side)
      add(2 * (side % 2 == 0 ? half.y() : half.x()), 2 * half.z(), false, false);
    add(2 * half.x(), 2 * half.y(), false, true);
  } else {
    add(2 * std::numbers::pi * half.x(), 2 * half.z(), true, false);
    add(2 * half.x(), 2 * half.x(), false, true);
  }
  return made;
}

}  // namespace prehend::recognition
