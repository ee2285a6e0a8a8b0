#include "common/arm/collision.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::arm {
namespace {

using Eigen::Vector3d;

constexpr double point_like = 1e-18;  // m², of a line

bool is_free(const model::ArmModel& arm, int a, int b) {
  if (a > b) std::swap(a, b);
  if (b - a < 2) return true;
  return std::find(arm.not_checked.begin(), arm.not_checked.end(), std::pair(a, b)) !=
         arm.not_checked.end();
}

}  // namespace

Nearest nearest(const model::Capsule& a, const model::Capsule& b) {
  const Vector3d u = a.b - a.a, v = b.b - b.a, w = a.a - b.a;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w),
               vw = v.dot(w);
  double s = 0, t = 0;
  if (uu < point_like) {
    t = vv < point_like ? 0 : std::clamp(vw / vv, 0.0, 1.0);
  } else if (vv < point_like) {
    s = std::clamp(-uw / uu, 0.0, 1.0);
  } else {
    const double area = uu * vv - uv * uv;
    s = area > 1e-12 * uu * vv ? std::clamp((uv * vw - vv * uw) / area, 0.0, 1.0) : 0.0;
    t = (uv * s + vw) / vv;
    if (t < 0) {
      t = 0;
      s = std::clamp(-uw / uu, 0.0, 1.0);
    } else if (t > 1) {
      t = 1;
      s = std::clamp((uv - uw) / uu, 0.0, 1.0);
    }
  }
  Nearest found;
  found.p_A = a.a + s * u;
  found.p_B = b.a + t * v;
  found.distance = (found.p_A - found.p_B).norm() - a.radius - b.radius;
  return found;
}

Collision::Collision(const model::ArmModel& arm, Surroundings surroundings)
    : table_(surroundings.table) {
  for (std::size_t link = 0; link < arm.links.size(); ++link)
    for (const model::Capsule& capsule : arm.links[link].capsules)
      parts_.push_back({static_cast<int>(link), capsule});
  const int last = static_cast<int>(arm.joints.size());
  for (const model::Capsule& capsule : surroundings.carried) parts_.push_back({last, capsule});
  for (std::size_t a = 0; a < parts_.size(); ++a)
    for (std::size_t b = a + 1; b < parts_.size(); ++b)
      if (!is_free(arm, parts_[a].link, parts_[b].link))
        pairs_.emplace_back(static_cast<int>(a), static_cast<int>(b));
}

std::vector<Collision::Pair> Collision::near(const Configuration& at, double range) const {
  std::vector<model::Capsule> placed;
  placed.reserve(parts_.size());
  for (const Part& part : parts_) {
    const Pose& X_AL = at.X_AL[static_cast<std::size_t>(part.link)];
    placed.push_back({X_AL * part.capsule.a, X_AL * part.capsule.b, part.capsule.radius});
  }
  std::vector<Pair> found;
  for (const auto& [a, b] : pairs_) {
    const model::Capsule &first = placed[static_cast<std::size_t>(a)],
                         &second = placed[static_cast<std::size_t>(b)];
    const Nearest gap = nearest(first, second);
    if (gap.distance > range) continue;
    const Vector3d way = gap.p_A - gap.p_B;
    const Vector3d direction =
        way.norm() > 1e-9 ? Vector3d(way.normalized()) : Vector3d(Vector3d::UnitZ());
    found.push_back({parts_[static_cast<std::size_t>(a)].link,
                     parts_[static_cast<std::size_t>(b)].link, gap.distance, gap.p_A, gap.p_B,
                     direction});
  }
  for (std::size_t a = 0; table_ && a < parts_.size(); ++a) {
    // What the first joint turns keeps its height, wherever it is.
    if (parts_[a].link < 2) continue;
    for (const Vector3d& end : {placed[a].a, placed[a].b}) {
      const double distance = end.z() - placed[a].radius - *table_;
      if (distance > range) continue;
      found.push_back(
          {parts_[a].link, -1, distance, end, {end.x(), end.y(), *table_}, Vector3d::UnitZ()});
    }
  }
  return found;
}

double Collision::clearance(const Configuration& at, double range) const {
  double least = range;
  for (const Pair& pair : near(at, range)) least = std::min(least, pair.distance);
  return least;
}

}  // namespace prehend::arm
