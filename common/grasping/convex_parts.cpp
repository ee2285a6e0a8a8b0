#include "common/grasping/convex_parts.hpp"

#include <LinearMath/btConvexHullComputer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace prehend::grasping {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

constexpr int columns = 64;           // of rays through the mesh along x and along y
constexpr std::size_t max_cuts = 10;  // tried along each axis

/// Corners of the convex hull, and its volume.
struct Hull {
  Points corners;
  double volume = 0;
};

Hull hull_of(const Points& points) {
  Hull hull;
  if (points.size() < 4) return hull;
  btConvexHullComputer computer;
  computer.compute(points.front().data(), static_cast<int>(sizeof(Vector3d)),
                   static_cast<int>(points.size()), 0, 0);
  for (int i = 0; i < computer.vertices.size(); ++i)
    hull.corners.emplace_back(computer.vertices[i].x(), computer.vertices[i].y(),
                              computer.vertices[i].z());
  for (int i = 0; i < computer.faces.size(); ++i) {
    const btConvexHullComputer::Edge* first = &computer.edges[computer.faces[i]];
    const Vector3d& a = hull.corners[static_cast<std::size_t>(first->getSourceVertex())];
    for (const auto* edge = first->getNextEdgeOfFace();
         edge->getTargetVertex() != first->getSourceVertex(); edge = edge->getNextEdgeOfFace()) {
      const Vector3d& b = hull.corners[static_cast<std::size_t>(edge->getSourceVertex())];
      const Vector3d& c = hull.corners[static_cast<std::size_t>(edge->getTargetVertex())];
      hull.volume += (a - hull.corners.front()).dot((b - a).cross(c - a)) / 6;
    }
  }
  hull.volume = std::abs(hull.volume);
  return hull;
}

/// What of a convex polygon lies on one side of a plane: sign * (p[axis] - at) >= 0.
Points clip(const Points& polygon, int axis, double at, double sign) {
  Points kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3d& p = polygon[i];
    const Vector3d& q = polygon[(i + 1) % polygon.size()];
    const double dp = sign * (p[axis] - at), dq = sign * (q[axis] - at);
    if (dp >= 0) kept.push_back(p);
    if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) {
      kept.push_back(p + dp / (dp - dq) * (q - p));
      kept.back()[axis] = at;
    }
  }
  return kept;
}

/// The inside of a mesh as intervals of z over a grid of (x, y).
class Columns {
 public:
  explicit Columns(const model::Mesh& mesh) {
    for (const Vector3d& vertex : mesh.vertices) box_.extend(vertex);
    step_ = box_.sizes() / columns;
    crossings_.resize(columns * columns);
    for (const Eigen::Vector3i& t : mesh.triangles)
      cross(mesh.vertices[static_cast<std::size_t>(t[0])],
            mesh.vertices[static_cast<std::size_t>(t[1])],
            mesh.vertices[static_cast<std::size_t>(t[2])]);
    for (auto& column : crossings_) std::sort(column.begin(), column.end());
  }

  const AlignedBox3d& box() const { return box_; }

  /// Of the solid inside the box, m³; in the whole about a percent off, by the grid.
  double volume(const AlignedBox3d& box) const {
    double sum = 0;
    for (int i = 0; i < columns; ++i) {
      const double width = overlap(i, 0, box);
      if (width <= 0) continue;
      for (int k = 0; k < columns; ++k) {
        const double depth = overlap(k, 1, box);
        if (depth <= 0) continue;
        const auto& column = crossings_[static_cast<std::size_t>(i * columns + k)];
        for (std::size_t n = 0; n + 1 < column.size(); n += 2)
          sum += width * depth *
                 std::max(0.0, std::min(column[n + 1], box.max().z()) -
                                   std::max(column[n], box.min().z()));
      }
    }
    return sum;
  }

  bool contains(const Vector3d& p) const {
    const auto index = [&](int axis) {
      return std::clamp(static_cast<int>((p[axis] - box_.min()[axis]) / step_[axis]), 0,
                        columns - 1);
    };
    const auto& column = crossings_[static_cast<std::size_t>(index(0) * columns + index(1))];
    return std::count_if(column.begin(), column.end(), [&](double z) { return z < p.z(); }) % 2;
  }

 private:
  /// How much of a column's width lies in the box.
  double overlap(int i, int axis, const AlignedBox3d& box) const {
    const double low = box_.min()[axis] + i * step_[axis];
    return std::min(low + step_[axis], box.max()[axis]) - std::max(low, box.min()[axis]);
  }

  void cross(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const Eigen::Vector2d ab = (b - a).head<2>(), ac = (c - a).head<2>();
    const double twice = ab.x() * ac.y() - ab.y() * ac.x();
    if (twice == 0) return;
    const auto range = [&](int axis) {
      const auto [low, high] = std::minmax({a[axis], b[axis], c[axis]});
      const auto at = [&](double value) {
        return std::clamp(static_cast<int>((value - box_.min()[axis]) / step_[axis]), 0,
                          columns - 1);
      };
      return std::pair(at(low), at(high));
    };
    const auto [first_x, last_x] = range(0);
    const auto [first_y, last_y] = range(1);
    for (int i = first_x; i <= last_x; ++i)
      for (int k = first_y; k <= last_y; ++k) {
        // A little off the middle, so that no ray meets an edge of a regular mesh.
        const Eigen::Vector2d p(box_.min().x() + (i + 0.5003) * step_.x() - a.x(),
                                box_.min().y() + (k + 0.5007) * step_.y() - a.y());
        const double u = (p.x() * ac.y() - p.y() * ac.x()) / twice;
        const double v = (ab.x() * p.y() - ab.y() * p.x()) / twice;
        if (u < 0 || v < 0 || u + v > 1) continue;
        crossings_[static_cast<std::size_t>(i * columns + k)].push_back(
            a.z() + u * (b.z() - a.z()) + v * (c.z() - a.z()));
      }
  }

  AlignedBox3d box_;
  Vector3d step_;
  std::vector<std::vector<double>> crossings_;  // of the column at i * columns + k
};

/// What lies in one box: the polygons of the surface there and the hull about them.
struct Piece {
  AlignedBox3d box;
  std::vector<Points> polygons;
  Hull hull;
  double excess = 0;  // m³, of the hull over the solid
  bool done = false;  // no cut makes it better
};

class Cutter {
 public:
  explicit Cutter(const model::Mesh& mesh) : inside_(mesh) {
    for (const Eigen::Vector3i& t : mesh.triangles)
      whole_.push_back({mesh.vertices[static_cast<std::size_t>(t[0])],
                        mesh.vertices[static_cast<std::size_t>(t[1])],
                        mesh.vertices[static_cast<std::size_t>(t[2])]});
  }

  Piece whole() const { return finish(inside_.box(), whole_); }

  /// The two pieces of the best cut, or none if it gains nothing.
  std::optional<std::pair<Piece, Piece>> cut(const Piece& piece) const {
    std::optional<std::pair<Piece, Piece>> best;
    double least = 0.98 * piece.excess;
    for (int axis = 0; axis < 3; ++axis)
      for (const double at : cuts(piece, axis)) {
        auto halves = std::pair(half(piece, axis, at, -1), half(piece, axis, at, 1));
        const double left = halves.first.excess + halves.second.excess;
        if (left >= least) continue;
        least = left;
        best = std::move(halves);
      }
    return best;
  }

 private:
  /// Where corners of the surface lie; evenly chosen when there are many.
  static std::vector<double> cuts(const Piece& piece, int axis) {
    const double low = piece.box.min()[axis], high = piece.box.max()[axis];
    const double margin = 0.02 * (high - low);
    std::vector<double> all;
    for (const Points& polygon : piece.polygons)
      for (const Vector3d& p : polygon)
        if (p[axis] > low + margin && p[axis] < high - margin) all.push_back(p[axis]);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end(),
                          [&](double a, double b) { return b - a < 0.1 * margin; }),
              all.end());
    if (all.empty()) return {0.5 * (low + high)};
    if (all.size() <= max_cuts) return all;
    std::vector<double> some;
    for (std::size_t i = 0; i < max_cuts; ++i)
      some.push_back(all[(2 * i + 1) * all.size() / (2 * max_cuts)]);
    return some;
  }

  Piece half(const Piece& piece, int axis, double at, double sign) const {
    AlignedBox3d box = piece.box;
    (sign > 0 ? box.min() : box.max())[axis] = at;
    std::vector<Points> polygons;
    for (const Points& polygon : piece.polygons) {
      Points kept = clip(polygon, axis, at, sign);
      // What only lies in the plane bounds the other half.
      const bool beyond = std::any_of(kept.begin(), kept.end(), [&](const Vector3d& p) {
        return sign * (p[axis] - at) > 1e-9;
      });
      if (beyond) polygons.push_back(std::move(kept));
    }
    return finish(box, std::move(polygons));
  }

  Piece finish(const AlignedBox3d& box, std::vector<Points> polygons) const {
    Piece piece{box, std::move(polygons), {}, 0, false};
    Points points;
    for (const Points& polygon : piece.polygons)
      points.insert(points.end(), polygon.begin(), polygon.end());
    // Corners of the box inside the solid are corners of the piece, too.
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d p = box.corner(static_cast<AlignedBox3d::CornerType>(corner));
      if (inside_.contains(p)) points.push_back(p);
    }
    piece.hull = hull_of(points);
    piece.excess = std::max(0.0, piece.hull.volume - inside_.volume(box));
    return piece;
  }

  Columns inside_;
  std::vector<Points> whole_;
};

}  // namespace

Expected<ConvexParts> convex_parts(const model::Mesh& mesh, const PartsOptions& options) {
  const auto solid = model::measure(mesh);
  if (!solid) return tl::unexpected(solid.error());
  if (options.max_parts < 1 || !(options.max_excess > 0))
    return fail("parts must be at least 1, their excess positive", "convex parts");
  const Cutter cutter(mesh);
  std::vector<Piece> pieces{cutter.whole()};
  if (!(pieces.front().hull.volume > 0)) return fail("mesh has no hull");
  ConvexParts made;
  made.concavity = std::max(0.0, pieces.front().hull.volume / solid->volume - 1);
  const auto excess = [&] {
    double volume = 0;
    for (const Piece& piece : pieces) volume += piece.hull.volume;
    return std::max(0.0, volume / solid->volume - 1);
  };
  while (excess() > options.max_excess && static_cast<int>(pieces.size()) < options.max_parts) {
    Piece* worst = nullptr;
    for (Piece& piece : pieces)
      if (!piece.done && (!worst || piece.excess > worst->excess)) worst = &piece;
    if (!worst) break;
    auto halves = cutter.cut(*worst);
    if (!halves) {
      worst->done = true;
      continue;
    }
    *worst = std::move(halves->first);
    pieces.push_back(std::move(halves->second));
  }
  made.excess = excess();
  for (Piece& piece : pieces)
    if (piece.hull.volume > 0) made.parts.push_back(std::move(piece.hull.corners));
  return made;
}

}  // namespace prehend::grasping
