#include "services/planner/tools/picture/drawing.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace prehend::planner {
namespace {

using Eigen::Vector3d;

constexpr double infinite = std::numeric_limits<double>::infinity();
const Vector3d lamp_colour(0.66, 0.63, 0.58);
const Vector3d sky_colour(0.40, 0.42, 0.46), ground_colour(0.20, 0.19, 0.18);
const Vector3d paper(0.965, 0.97, 0.975);       // the picture's background, sRGB
const Vector3d floor_colour(0.87, 0.88, 0.90);  // sRGB
const Vector3d line_colour(0.76, 0.78, 0.81);
constexpr double grid = 0.05;           // m, between the floor's lines
constexpr double line_width = 0.0007;   // m
constexpr int map_size = 1400;          // of the lamp's depth map, each way
constexpr double bias = 0.0015;         // m, that a surface does not shade itself
constexpr double blur = 0.0022;         // m, between the samples of a soft shadow's edge
constexpr double edge_depth = 0.004;    // m, a step of depth that gets a line
constexpr double edge_angle = 0.75;     // cosine, of normals that get one
constexpr double edge_strength = 0.45;  // how dark it is

double linear(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
Vector3d linear(const Vector3d& c) {
  return {linear(c.x()), linear(c.y()), linear(c.z())};
}
double srgb(double c) {
  c = std::clamp(c, 0.0, 1.0);
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

/// Calls at(x, y, a, b, c) with barycentric coordinates for each pixel whose middle is inside.
template <class At>
void fill(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, int width,
          int height, At at) {
  const double area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  if (std::abs(area) < 1e-12) return;
  const int x0 = std::max(0, static_cast<int>(std::ceil(std::min({a.x(), b.x(), c.x()}) - 0.5)));
  const int x1 =
      std::min(width - 1, static_cast<int>(std::floor(std::max({a.x(), b.x(), c.x()}) - 0.5)));
  const int y0 = std::max(0, static_cast<int>(std::ceil(std::min({a.y(), b.y(), c.y()}) - 0.5)));
  const int y1 =
      std::min(height - 1, static_cast<int>(std::floor(std::max({a.y(), b.y(), c.y()}) - 0.5)));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const double px = x + 0.5, py = y + 0.5;
      const double u = ((b.x() - px) * (c.y() - py) - (b.y() - py) * (c.x() - px)) / area;
      const double v = ((c.x() - px) * (a.y() - py) - (c.y() - py) * (a.x() - px)) / area;
      if (u >= 0 && v >= 0 && u + v <= 1) at(x, y, u, v, 1 - u - v);
    }
}

/// The nearest surface behind each pixel.
struct Layer {
  int width, height;
  std::vector<float> depth;  // along the view, m; infinite: nothing
  std::vector<Eigen::Vector3f> normal;
  std::vector<std::int16_t> paint;

  Layer(int w, int h)
      : width(w),
        height(h),
        depth(static_cast<std::size_t>(w) * static_cast<std::size_t>(h),
              std::numeric_limits<float>::infinity()),
        normal(depth.size(), Eigen::Vector3f::Zero()),
        paint(depth.size(), -1) {}

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(x);
  }
};

/// The lamp hangs high on the viewer's left, so that what is seen is lit.
Vector3d lamp_of(const Viewpoint& view) {
  const Vector3d right = view.X_WV.linear().col(0);
  const Vector3d towards_viewer = Vector3d::UnitZ().cross(right).normalized() * -1;
  return (1.0 * Vector3d::UnitZ() - 0.45 * right + 0.55 * towards_viewer).normalized();
}

/// How the pixels of a view lie in W.
struct Lens {
  const Viewpoint& view;
  int width, height;
  Pose X_VW = view.X_WV.inverse();
  double focal = width / view.width;  // px
  Vector3d to_lamp = lamp_of(view);

  /// Along the ray of a pixel's middle, per unit of depth.
  Vector3d ray(int x, int y) const {
    return view.X_WV.linear() *
           Vector3d((x + 0.5 - 0.5 * width) / focal, (y + 0.5 - 0.5 * height) / focal, 1);
  }
};

void paint_layer(const std::vector<Triangle>& triangles, const Lens& lens, Layer& layer) {
  for (const Triangle& triangle : triangles) {
    Vector3d p[3];
    Eigen::Vector2d s[3];
    for (int i = 0; i < 3; ++i) {
      p[i] = lens.X_VW * triangle.p[i];
      if (p[i].z() < 1e-3) return;
      s[i] = lens.focal * p[i].head<2>() / p[i].z() +
             Eigen::Vector2d(0.5 * lens.width, 0.5 * lens.height);
    }
    // Turned away: closed surfaces hide their back.
    if ((p[1] - p[0]).cross(p[2] - p[0]).dot(p[0]) *
            (triangle.p[1] - triangle.p[0])
                .cross(triangle.p[2] - triangle.p[0])
                .dot(triangle.n[0] + triangle.n[1] + triangle.n[2]) >
        0)
      continue;
    fill(s[0], s[1], s[2], lens.width, lens.height,
         [&](int x, int y, double a, double b, double c) {
           const double w = a / p[0].z() + b / p[1].z() + c / p[2].z();
           const auto depth = static_cast<float>(1 / w);
           const std::size_t i = layer.at(x, y);
           if (depth >= layer.depth[i]) return;
           layer.depth[i] = depth;
           layer.normal[i] = (a / p[0].z() * triangle.n[0] + b / p[1].z() * triangle.n[1] +
                              c / p[2].z() * triangle.n[2])
                                 .normalized()
                                 .cast<float>();
           layer.paint[i] = static_cast<std::int16_t>(triangle.paint);
         });
  }
}

/// What the lamp reaches: depths along its rays, seen from above the scene.
class LampMap {
 public:
  LampMap(const Drawing& drawing, const Vector3d& to_lamp, bool clear_too)
      : to_lamp_(to_lamp), depth_(map_size * map_size, infinite) {
    for (const Triangle& triangle : drawing.triangles)
      for (const Vector3d& p : triangle.p) centre_ += p / 3;
    centre_ /= std::max<double>(1, static_cast<double>(drawing.triangles.size()));
    for (const Triangle& triangle : drawing.triangles)
      for (const Vector3d& p : triangle.p) radius_ = std::max(radius_, (p - centre_).norm());
    right_ = to_lamp.unitOrthogonal();
    up_ = to_lamp.cross(right_);
    for (const Triangle& triangle : drawing.triangles) {
      if (!clear_too && drawing.paints[static_cast<std::size_t>(triangle.paint)].opacity < 1)
        continue;
      Vector3d m[3];
      for (int i = 0; i < 3; ++i) m[i] = mapped(triangle.p[i]);
      fill(m[0].head<2>(), m[1].head<2>(), m[2].head<2>(), map_size, map_size,
           [&](int x, int y, double a, double b, double c) {
             double& depth = depth_[static_cast<std::size_t>(y * map_size + x)];
             depth = std::min(depth, a * m[0].z() + b * m[1].z() + c * m[2].z());
           });
    }
  }

  /// Share of the lamp that is seen from p.
  double light(const Vector3d& p) const {
    const Vector3d m = mapped(p);
    const double step = blur * scale();
    int lit = 0, all = 0;
    for (int i = -2; i <= 2; ++i)
      for (int k = -2; k <= 2; ++k) {
        const int x = static_cast<int>(m.x() + i * step), y = static_cast<int>(m.y() + k * step);
        ++all;
        if (x < 0 || y < 0 || x >= map_size || y >= map_size ||
            depth_[static_cast<std::size_t>(y * map_size + x)] > m.z() - bias)
          ++lit;
      }
    return static_cast<double>(lit) / all;
  }

 private:
  double scale() const { return 0.5 * map_size / radius_; }
  Vector3d mapped(const Vector3d& p) const {
    const Vector3d d = p - centre_;
    return {0.5 * map_size + scale() * right_.dot(d), 0.5 * map_size + scale() * up_.dot(d),
            -to_lamp_.dot(d)};
  }

  Vector3d to_lamp_, centre_ = Vector3d::Zero(), right_, up_;
  double radius_ = 1e-6;
  std::vector<double> depth_;  // m
};

/// A surface's colour, linear.
Vector3d shade(const Paint& paint, const Vector3d& n, const Vector3d& to_eye,
               const Vector3d& to_lamp, double lamp) {
  const Vector3d albedo = linear(paint.colour);
  const double facing = std::max(0.0, n.dot(to_lamp));
  const Vector3d sky = (0.5 + 0.5 * n.z()) * sky_colour + (0.5 - 0.5 * n.z()) * ground_colour;
  const double glint =
      std::pow(std::max(0.0, n.dot((to_lamp + to_eye).normalized())), 40) * paint.gloss;
  const double rim = std::pow(1 - std::max(0.0, n.dot(to_eye)), 3) * 0.10;
  const Vector3d lit = albedo.cwiseProduct(sky + lamp * facing * lamp_colour) +
                       lamp * glint * lamp_colour + rim * sky_colour;
  return paint.glow * albedo + (1 - paint.glow) * lit;
}

class Shading {
 public:
  Shading(const Drawing& drawing, const Lens& lens)
      : drawing_(drawing),
        lens_(lens),
        on_floor_(drawing, lens.to_lamp, true),
        on_solids_(drawing, lens.to_lamp, false) {}

  Vector3d colour(const Layer& layer, int x, int y) const {
    const std::size_t i = layer.at(x, y);
    const Vector3d ray = lens_.ray(x, y);
    if (layer.paint[i] < 0) return floor(ray);
    const Vector3d p = lens_.view.X_WV.translation() + layer.depth[i] * ray;
    const Vector3d n = layer.normal[i].cast<double>();
    const double lit = n.dot(lens_.to_lamp) > 0 ? on_solids_.light(p + 0.0005 * n) : 0;
    const Vector3d made = shade(drawing_.paints[static_cast<std::size_t>(layer.paint[i])], n,
                                -ray.normalized(), lens_.to_lamp, lit);
    return (1 - edge_strength * edge(layer, x, y)) * made;
  }

 private:
  /// The floor with its grid and the shadows on it; it dissolves into the background.
  Vector3d floor(const Vector3d& ray) const {
    const Vector3d eye = lens_.view.X_WV.translation();
    const Vector3d far = linear(paper);
    if (ray.z() > -1e-6) return far;
    const Vector3d p = eye + (drawing_.floor - eye.z()) / ray.z() * ray;
    const auto off_line = [](double v) { return std::abs(v / grid - std::round(v / grid)) * grid; };
    const double off = std::min(off_line(p.x()), off_line(p.y()));
    const Vector3d albedo = linear(off < line_width ? line_colour : floor_colour);
    const Vector3d lit = albedo * (0.60 + 0.42 * on_floor_.light(p));
    const double fade = std::exp(-std::pow(p.head<2>().norm() / 0.42, 4));
    return fade * lit + (1 - fade) * far;
  }

  /// 1 where another surface begins.
  static double edge(const Layer& layer, int x, int y) {
    const std::size_t i = layer.at(x, y);
    for (const auto& [dx, dy] : {std::pair(1, 0), std::pair(0, 1)}) {
      if (x + dx >= layer.width || y + dy >= layer.height) continue;
      const std::size_t k = layer.at(x + dx, y + dy);
      if (layer.paint[k] < 0 || std::abs(layer.depth[i] - layer.depth[k]) > edge_depth ||
          layer.normal[i].dot(layer.normal[k]) < edge_angle)
        return 1;
    }
    return 0;
  }

  const Drawing& drawing_;
  const Lens& lens_;
  /// What one can see through throws a shadow on the floor, but none on what is inside.
  LampMap on_floor_, on_solids_;
};

/// Those of one opacity, opaque or not.
std::vector<Triangle> some(const Drawing& drawing, bool opaque) {
  std::vector<Triangle> found;
  for (const Triangle& triangle : drawing.triangles)
    if ((drawing.paints[static_cast<std::size_t>(triangle.paint)].opacity >= 1) == opaque)
      found.push_back(triangle);
  return found;
}

}  // namespace

Raster Drawing::draw(const Viewpoint& view, int width, int height, int samples) const {
  const Lens lens{view, width * samples, height * samples};
  Layer solid(lens.width, lens.height), clear(lens.width, lens.height);
  paint_layer(some(*this, true), lens, solid);
  paint_layer(some(*this, false), lens, clear);
  const Shading shading(*this, lens);
  Raster raster{width, height, {}};
  raster.rgb.reserve(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      Vector3d sum = Vector3d::Zero();
      for (int k = 0; k < samples * samples; ++k) {
        const int sx = x * samples + k % samples, sy = y * samples + k / samples;
        Vector3d colour = shading.colour(solid, sx, sy);
        const std::size_t i = clear.at(sx, sy);
        if (clear.depth[i] < solid.depth[i]) {
          const double opacity = paints[static_cast<std::size_t>(clear.paint[i])].opacity;
          colour = opacity * shading.colour(clear, sx, sy) + (1 - opacity) * colour;
        }
        sum += colour;
      }
      for (const double channel : sum / (samples * samples))
        raster.rgb.push_back(static_cast<std::uint8_t>(std::lround(255 * srgb(channel))));
    }
  return raster;
}

std::vector<int> Drawing::coverage(const Viewpoint& view, int width, int height) const {
  const Lens lens{view, width, height};
  std::vector<int> count(paints.size(), 0);
  Layer solid(width, height), clear(width, height);
  paint_layer(some(*this, true), lens, solid);
  paint_layer(some(*this, false), lens, clear);
  for (std::size_t i = 0; i < solid.depth.size(); ++i) {
    if (solid.paint[i] >= 0) ++count[static_cast<std::size_t>(solid.paint[i])];
    if (clear.paint[i] >= 0 && clear.depth[i] < solid.depth[i])
      ++count[static_cast<std::size_t>(clear.paint[i])];
  }
  return count;
}

}  // namespace prehend::planner
