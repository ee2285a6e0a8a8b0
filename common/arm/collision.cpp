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

Joints levers(const model::ArmModel& arm, const std::vector<model::Capsule>& carried) {
  const auto count = static_cast<Eigen::Index>(arm.joints.size());
  Joints lever = Joints::Zero(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    double length = 0;
    for (Eigen::Index j = i; j < count; ++j) {
      if (j > i) length += arm.joints[static_cast<std::size_t>(j)].X_PJ.translation().norm();
      std::vector<model::Capsule> shapes = arm.links[static_cast<std::size_t>(j) + 1].capsules;
      if (j + 1 == count) shapes.insert(shapes.end(), carried.begin(), carried.end());
      for (const model::Capsule& shape : shapes)
        lever[i] =
            std::max(lever[i], length + shape.radius + std::max(shape.a.norm(), shape.b.norm()));
    }
  }
  return lever;
}

Collision::Collision(const model::ArmModel& arm, Surroundings surroundings)
    : table_(surroundings.table) {
  for (std::size_t link = 0; link < arm.links.size(); ++link)
    for (const model::Capsule& capsule : arm.links[link].capsules)
      parts_.push_back({static_cast<int>(link), capsule, false});
  const int last = static_cast<int>(arm.joints.size());
  for (const model::Capsule& capsule : surroundings.carried)
    parts_.push_back({last, capsule, surroundings.may_touch});
  for (std::size_t a = 0; a < parts_.size(); ++a)
    for (std::size_t b = a + 1; b < parts_.size(); ++b)
      if (!is_free(arm, parts_[a].link, parts_[b].link))
        pairs_.emplace_back(static_cast<int>(a), static_cast<int>(b));
}

template <class Visit>
void Collision::visit(const Configuration& at, const double& range, const Visit& visit) const {
  struct Placed {
    model::Capsule capsule;
    Vector3d middle;
    double size = 0;  // of the sphere around it
  };
  std::vector<Placed> placed;
  placed.reserve(parts_.size());
  for (const Part& part : parts_) {
    const Pose& X_AL = at.X_AL[static_cast<std::size_t>(part.link)];
    const Vector3d a = X_AL * part.capsule.a, b = X_AL * part.capsule.b;
    placed.push_back(
        {{a, b, part.capsule.radius}, 0.5 * (a + b), 0.5 * (a - b).norm() + part.capsule.radius});
  }
  for (const auto& [a, b] : pairs_) {
    const Placed &first = placed[static_cast<std::size_t>(a)],
                 &second = placed[static_cast<std::size_t>(b)];
    const double far = range + first.size + second.size;  // spheres first: most are far away
    if (far < 0 || (first.middle - second.middle).squaredNorm() > far * far) continue;
    const Nearest gap = nearest(first.capsule, second.capsule);
    if (gap.distance <= range) visit(a, b, gap);
  }
  for (std::size_t a = 0; table_ && a < parts_.size(); ++a) {
    // What the first joint turns keeps its height, wherever it is.
    if (parts_[a].link < 2 || parts_[a].may_touch) continue;
    for (const Vector3d& end : {placed[a].capsule.a, placed[a].capsule.b}) {
      const double distance = end.z() - placed[a].capsule.radius - *table_;
      if (distance <= range)
        visit(static_cast<int>(a), -1, Nearest{distance, end, {end.x(), end.y(), *table_}});
    }
  }
}

std::vector<Collision::Pair> Collision::near(const Configuration& at, double range) const {
  std::vector<Pair> found;
  visit(at, range, [&](int a, int b, const Nearest& gap) {
    const int first = parts_[static_cast<std::size_t>(a)].link;
    const int second = b < 0 ? -1 : parts_[static_cast<std::size_t>(b)].link;
    const Vector3d way = gap.p_A - gap.p_B;
    const bool is_up = b < 0 || way.norm() <= 1e-9;
    const Vector3d direction = is_up ? Vector3d(Vector3d::UnitZ()) : Vector3d(way.normalized());
    found.push_back({first, second, gap.distance, gap.p_A, gap.p_B, direction});
  });
  return found;
}

double Collision::clearance(const Configuration& at, double range) const {
  double least = range;
  visit(at, least, [&](int, int, const Nearest& gap) { least = std::min(least, gap.distance); });
  return least;
}

}  // namespace prehend::arm
