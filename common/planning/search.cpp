#include <algorithm>
#include <limits>

#include "common/base/random.hpp"
#include "common/planning/ground.hpp"

namespace prehend::planning {
namespace {

using arm::Joints;

constexpr double around = 0.6;  // rad, about start and goals, from where every second sample comes

struct Tree {
  struct Node {
    Joints q;
    int parent = -1;
  };
  std::vector<Node> nodes;

  int nearest(const Ground& ground, const Joints& q) const {
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (const double far = ground.length(nodes[i].q, q); far < least) {
        least = far;
        best = static_cast<int>(i);
      }
    return best;
  }

  /// Grows towards q; true: it has come so far that its newest node is there.
  bool grow(const Ground& ground, const Joints& q, double longest) {
    int parent = nearest(ground, q);
    for (const Joints& next : ground.walk(nodes[static_cast<std::size_t>(parent)].q, q, longest)) {
      nodes.push_back({next, parent});
      parent = static_cast<int>(nodes.size()) - 1;
    }
    return nodes.back().q == q;
  }

  /// From the newest node to its root.
  Path branch() const {
    Path path;
    for (int i = static_cast<int>(nodes.size()) - 1; i >= 0;
         i = nodes[static_cast<std::size_t>(i)].parent)
      path.push_back(nodes[static_cast<std::size_t>(i)].q);
    return path;
  }
};

class Sampler {
 public:
  Sampler(const model::ArmModel& arm, const Joints& start, const std::vector<Joints>& goals,
          std::uint64_t seed)
      : random_(seed) {
    const auto count = static_cast<Eigen::Index>(arm.joints.size());
    lower_.resize(count);
    upper_.resize(count);
    near_lower_ = near_upper_ = start;
    for (const Joints& goal : goals) {
      near_lower_ = near_lower_.cwiseMin(goal);
      near_upper_ = near_upper_.cwiseMax(goal);
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      lower_[i] = arm.joints[static_cast<std::size_t>(i)].lower;
      upper_[i] = arm.joints[static_cast<std::size_t>(i)].upper;
      near_lower_[i] = std::max(lower_[i], near_lower_[i] - around);
      near_upper_[i] = std::min(upper_[i], near_upper_[i] + around);
    }
  }

  Joints next() {
    is_near_ = !is_near_;
    const Joints &low = is_near_ ? near_lower_ : lower_, &high = is_near_ ? near_upper_ : upper_;
    Joints q(low.size());
    for (Eigen::Index i = 0; i < q.size(); ++i) q[i] = random_.uniform(low[i], high[i]);
    return q;
  }

 private:
  Random random_;
  bool is_near_ = false;
  Joints lower_, upper_, near_lower_, near_upper_;
};

std::optional<Path> join(const model::ArmModel& arm, const Ground& ground, const Joints& start,
                         const std::vector<Joints>& goals, const SearchOptions& options) {
  Tree from, to;
  from.nodes.push_back({start});
  for (const Joints& goal : goals) to.nodes.push_back({goal});
  Sampler sampler(arm, start, goals, options.seed);
  Tree *growing = &from, *other = &to;
  for (int n = 0; n < options.max_iterations; ++n, std::swap(growing, other)) {
    const std::size_t before = growing->nodes.size();
    growing->grow(ground, sampler.next(), options.step);
    if (growing->nodes.size() == before) continue;
    if (!other->grow(ground, growing->nodes.back().q, std::numeric_limits<double>::infinity()))
      continue;
    Path path = from.branch();
    std::reverse(path.begin(), path.end());
    const Path rest = to.branch();
    path.insert(path.end(), rest.begin() + 1, rest.end());
    return path;
  }
  return std::nullopt;
}

/// Goes straight between two postures of the path, where that is shorter.
void shorten(const Ground& ground, Path& path, const SearchOptions& options) {
  Random random(options.seed + 1);
  for (int n = 0; n < options.shortcuts && path.size() > 2; ++n) {
    std::size_t a = random.index(path.size()), b = random.index(path.size());
    if (a > b) std::swap(a, b);
    if (b - a < 2) continue;
    const Path old(path.begin() + static_cast<std::ptrdiff_t>(a),
                   path.begin() + static_cast<std::ptrdiff_t>(b) + 1);
    if (ground.length(old) < 1.001 * ground.length(old.front(), old.back())) continue;
    const auto way = ground.way(old.front(), old.back());
    if (!way) continue;
    Path direct{old.front()};
    direct.insert(direct.end(), way->begin(), way->end());
    if (ground.length(direct) > 0.999 * ground.length(old)) continue;
    path.erase(path.begin() + static_cast<std::ptrdiff_t>(a) + 1,
               path.begin() + static_cast<std::ptrdiff_t>(b) + 1);
    path.insert(path.begin() + static_cast<std::ptrdiff_t>(a) + 1, way->begin(), way->end());
  }
}

}  // namespace

std::optional<Path> search(const model::ArmModel& arm, const Ground& ground, const Joints& start,
                           const std::vector<Joints>& goals, const SearchOptions& options) {
  std::vector<Joints> nearest = goals;
  std::stable_sort(nearest.begin(), nearest.end(), [&](const Joints& a, const Joints& b) {
    return ground.length(start, a) < ground.length(start, b);
  });
  for (const Joints& goal : nearest) {
    if (goal == start) return Path{start};
    if (auto way = ground.way(start, goal)) {
      way->insert(way->begin(), start);
      return way;
    }
  }
  auto path = join(arm, ground, start, nearest, options);
  if (path) shorten(ground, *path, options);
  return path;
}

}  // namespace prehend::planning
