#include "services/recognition/core/geometry/silhouette.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace prehend::recognition {
namespace {

/// Andrew's monotone chain; counter-clockwise in a frame with y up, no repeated point.
std::vector<Eigen::Vector2d> convex_hull(std::vector<Eigen::Vector2d>& points) {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  const auto turn = [](const auto& o, const auto& a, const auto& b) {
    return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
  };
  std::vector<Eigen::Vector2d> hull(2 * points.size());
  std::size_t n = 0;
  for (const auto& p : points) {
    while (n >= 2 && turn(hull[n - 2], hull[n - 1], p) <= 0) --n;
    hull[n++] = p;
  }
  const std::size_t lower = n + 1;
  for (auto p = points.rbegin() + 1; p != points.rend(); ++p) {
    while (n >= lower && turn(hull[n - 2], hull[n - 1], *p) <= 0) --n;
    hull[n++] = *p;
  }
  hull.resize(n > 0 ? n - 1 : 0);
  return hull;
}

}  // namespace

int Silhouette::area() const {
  int sum = 0;
  for (const Span& span : rows) sum += std::max(0, span.right - span.left);
  return sum;
}

void Silhouette::mark(Plane& plane, std::uint8_t value) const {
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (int x = rows[i].left; x < rows[i].right; ++x)
      plane.at(x, top + static_cast<int>(i)) = value;
}

Pose standing_pose(const model::Shape& shape, const TablePose& at) {
  return make_pose({at.x, at.y, model::half_extents(shape).z()},
                   Eigen::AngleAxisd(at.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix());
}

std::optional<std::vector<Eigen::Vector2d>> outline(const CameraModel& camera,
                                                    const model::Shape& shape, const TablePose& at,
                                                    double margin) {
  const Eigen::Vector3d half = model::half_extents(shape);
  const double top = 2 * half.z() + margin;
  const double c = std::cos(at.yaw), s = std::sin(at.yaw);
  std::vector<Eigen::Vector2d> points;
  const auto add = [&](double u, double v, double z) {
    const auto pixel = camera.project({at.x + c * u - s * v, at.y + s * u + c * v, z});
    if (pixel) points.push_back(*pixel);
    return pixel.has_value();
  };
  const double hx = half.x() + margin, hy = half.y() + margin;
  if (shape.kind == model::ShapeKind::box) {
    for (const double u : {-hx, hx})
      for (const double v : {-hy, hy})
        for (const double z : {0.0, top})
          if (!add(u, v, z)) return std::nullopt;
  } else if (model::is_upright_round(shape.kind)) {
    constexpr int corners = 20;
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * std::numbers::pi * i / corners;
      for (const double z : {0.0, top}) {
        const double radius = model::radius_at(shape, z - half.z()) + margin;
        if (!add(radius * std::cos(angle), radius * std::sin(angle), z)) return std::nullopt;
      }
    }
  } else {  // a sphere; rings of latitude
    constexpr int corners = 24;
    for (int ring = -4; ring <= 4; ++ring) {
      const double latitude = ring * std::numbers::pi / 8;
      for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * i / corners;
        if (!add(hx * std::cos(latitude) * std::cos(angle),
                 hx * std::cos(latitude) * std::sin(angle), half.z() + hx * std::sin(latitude)))
          return std::nullopt;
      }
    }
  }
  return convex_hull(points);
}

std::optional<Silhouette> silhouette(const CameraModel& camera, const model::Shape& shape,
                                     const TablePose& at, double margin) {
  const auto hull = outline(camera, shape, at, margin);
  if (!hull || hull->size() < 3) return std::nullopt;
  double low = hull->front().y(), high = low;
  for (const auto& p : *hull) {
    low = std::min(low, p.y());
    high = std::max(high, p.y());
  }
  // A pixel belongs to the region when its centre does; pixel centres are whole numbers.
  const int first = std::max(0, static_cast<int>(std::ceil(std::clamp(low, -1e6, 1e6))));
  const int last =
      std::min(camera.height - 1, static_cast<int>(std::floor(std::clamp(high, -1e6, 1e6))));
  if (last < first) return std::nullopt;
  Silhouette made;
  made.top = first;
  const auto count = static_cast<std::size_t>(last - first + 1);
  std::vector<double> left(count, 1e9), right(count, -1e9);
  for (std::size_t i = 0; i < hull->size(); ++i) {
    Eigen::Vector2d a = (*hull)[i], b = (*hull)[(i + 1) % hull->size()];
    if (a.y() > b.y()) std::swap(a, b);
    const int from = std::max(first, static_cast<int>(std::ceil(std::clamp(a.y(), -1e6, 1e6))));
    const int to = std::min(last, static_cast<int>(std::floor(std::clamp(b.y(), -1e6, 1e6))));
    const double slope = b.y() > a.y() ? (b.x() - a.x()) / (b.y() - a.y()) : 0;
    for (int y = from; y <= to; ++y) {
      const double x = a.x() + slope * (y - a.y());
      const auto row = static_cast<std::size_t>(y - first);
      left[row] = std::min(left[row], x);
      right[row] = std::max(right[row], x);
    }
  }
  made.rows.resize(count);
  bool any = false;
  for (std::size_t row = 0; row < count; ++row) {
    if (right[row] < left[row]) continue;
    Silhouette::Span& span = made.rows[row];
    span.left = static_cast<int>(std::ceil(std::clamp(left[row], 0.0, double(camera.width))));
    span.right = static_cast<int>(std::floor(std::clamp(right[row], -1.0, camera.width - 1.0))) + 1;
    any = any || span.right > span.left;
  }
  if (!any) return std::nullopt;
  return made;
}

}  // namespace prehend::recognition
