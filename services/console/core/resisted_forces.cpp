#include "services/console/core/resisted_forces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/analysis/contact_wrenches.hpp"
#include "common/analysis/convex_hull.hpp"
#include "common/analysis/resistance.hpp"

namespace prehend::console {
namespace {

constexpr std::size_t max_counted = 8;
constexpr int edges = 6;                         // of a friction cone
constexpr int ring_count = 10, step_count = 20;  // of the directions that are looked at
constexpr double lever = 0.05;                   // m, scales moments for the hull's numerics alone

/// Pole, ring_count, pole.
Eigen::Vector3d direction(int ring, int step) {
  const double polar = EIGEN_PI * ring / ring_count, turn = 2 * EIGEN_PI * step / step_count;
  return {std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar)};
}

}  // namespace

std::vector<Eigen::Vector3d> resisted_forces(const std::vector<analysis::Contact>& contacts) {
  const Eigen::MatrixXd wrenches =
      analysis::contact_wrenches(analysis::spread_contacts(contacts, max_counted), lever, edges);
  if (!wrenches.allFinite() || wrenches.cols() <= wrenches.rows() ||
      !analysis::spans_all_dimensions(wrenches))
    return {};
  const auto hull = analysis::convex_hull(wrenches);
  if (!hull || hull->offsets.minCoeff() < analysis::min_epsilon) return {};
  // How far the hull reaches along a force: to the first of its planes. What can be applied one way
  // resists a load the other way.
  const auto reach = [&](const Eigen::Vector3d& along) -> Eigen::Vector3d {
    double nearest = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < hull->offsets.size(); ++i) {
      const double slope = -hull->normals.col(i).head<3>().dot(along);
      if (slope > 0) nearest = std::min(nearest, hull->offsets[i] / slope);
    }
    return nearest * along;
  };
  std::vector<std::vector<Eigen::Vector3d>> corners(ring_count + 1);
  for (int ring = 0; ring <= ring_count; ++ring)
    for (int step = 0; step < step_count; ++step)
      corners[static_cast<std::size_t>(ring)].push_back(reach(direction(ring, step)));
  std::vector<Eigen::Vector3d> triangles;
  for (std::size_t ring = 0; ring < ring_count; ++ring)
    for (std::size_t step = 0; step < step_count; ++step) {
      const std::size_t next = (step + 1) % step_count;
      const auto &above = corners[ring], &below = corners[ring + 1];
      if (ring > 0) triangles.insert(triangles.end(), {above[step], below[step], above[next]});
      if (ring + 1 < ring_count)
        triangles.insert(triangles.end(), {above[next], below[step], below[next]});
    }
  return triangles;
}

}  // namespace prehend::console
