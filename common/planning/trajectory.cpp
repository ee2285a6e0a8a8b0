#include "common/planning/trajectory.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::planning {
namespace {

using arm::Joints;

constexpr double for_bends = 0.5;  // of the acceleration at most; the rest speeds up and brakes
constexpr double tiny = 1e-12;

/// Limits of a path in its own measure, in which the way from corner to corner is 1.
class PathLimits {
 public:
  PathLimits(const Robot& robot, const Path& path, const Pace& pace)
      : path_(path), pace_(pace), arm_(*robot.arm) {
    for (std::size_t i = 0; i < path.size(); ++i) poses_.push_back(robot.hand_at(path[i]));
  }

  Joints slope(std::size_t edge) const { return path_[edge + 1] - path_[edge]; }

  /// How much the slope changes about a corner; nothing at the ends.
  Joints bend(std::size_t corner) const {
    if (corner == 0 || corner + 1 == path_.size()) return Joints::Zero(path_.front().size());
    return slope(corner) - slope(corner - 1);
  }

  /// Greatest square of the speed in the middle of an edge.
  double max_square(std::size_t edge) const {
    double least = 1e12;
    const Joints way = slope(edge);
    for (Eigen::Index j = 0; j < way.size(); ++j) {
      const auto& joint = arm_.joints[static_cast<std::size_t>(j)];
      least = std::min(least, square(pace_.velocity * joint.velocity / size(way[j])));
      for (const std::size_t corner : {edge, edge + 1})
        least = std::min(
            least, for_bends * pace_.acceleration * joint.acceleration / size(bend(corner)[j]));
    }
    const double moved = (poses_[edge + 1].translation() - poses_[edge].translation()).norm(),
                 turned = angle_between(poses_[edge + 1].linear(), poses_[edge].linear());
    return std::min({least, square(pace_.hand / size(moved)), square(pace_.turn / size(turned))});
  }

  /// Greatest acceleration about a corner with this square of the speed.
  double max_gain(std::size_t corner, double squared) const {
    double least = 1e12;
    const Joints turn = bend(corner);
    Joints way = Joints::Zero(turn.size());
    if (corner > 0) way = slope(corner - 1).cwiseAbs();
    if (corner + 1 < path_.size()) way = way.cwiseMax(slope(corner).cwiseAbs());
    for (Eigen::Index j = 0; j < way.size(); ++j) {
      const double most =
          pace_.acceleration * arm_.joints[static_cast<std::size_t>(j)].acceleration;
      least = std::min(least, (most - std::abs(turn[j]) * squared) / size(way[j]));
    }
    return std::max(least, 0.0);
  }

 private:
  static double square(double x) { return x * x; }
  static double size(double x) { return std::max(std::abs(x), tiny); }

  const Path& path_;
  const Pace& pace_;
  const model::ArmModel& arm_;
  std::vector<Pose> poses_;
};

}  // namespace

Trajectory timed(const Robot& robot, const Path& path, const Pace& pace) {
  Trajectory made;
  made.corners_ = path;
  if (path.size() < 2) return made;
  const PathLimits limits(robot, path, pace);
  const std::size_t edges = path.size() - 1;
  // Squares of the speed: at the begin, in the middle of each edge, at the end.
  std::vector<double> squares(edges + 2, 0);
  std::vector<double> most(edges + 2, 0);
  for (std::size_t e = 0; e < edges; ++e) most[e + 1] = limits.max_square(e);
  const auto length = [&](std::size_t corner) {
    return corner == 0 || corner == edges ? 0.5 : 1.0;
  };
  // About a corner the greater of both speeds bends the way.
  const auto gain = [&](std::size_t corner) {
    return limits.max_gain(corner, std::max(most[corner], most[corner + 1]));
  };
  for (std::size_t c = 0; c < edges; ++c)
    squares[c + 1] = std::min(most[c + 1], squares[c] + 2 * length(c) * gain(c));
  for (std::size_t c = edges; c > 0; --c)
    squares[c] = std::min(squares[c], squares[c + 1] + 2 * length(c) * gain(c));
  double t = 0, s = 0;
  for (std::size_t c = 0; c <= edges; ++c) {
    const double from = std::sqrt(squares[c]), to = std::sqrt(squares[c + 1]);
    Trajectory::Span span{t, 2 * length(c) / std::max(from + to, tiny), s, from, 0};
    span.gain = (to - from) / span.time;
    made.spans_.push_back(span);
    t += span.time;
    s += length(c);
  }
  return made;
}

/// The quadratic B-spline of the corners: straight in the middle of each edge, and at both ends.
Joints Trajectory::on_path(double s) const {
  const auto last = static_cast<double>(corners_.size() - 1);
  const double in = std::clamp(s, 0.0, last);
  const auto corner = static_cast<std::size_t>(std::lround(in));
  const double u = in - static_cast<double>(corner);  // -0.5 to 0.5
  const Joints& middle = corners_[corner];
  if (corner == 0) return middle + u * (corners_[1] - middle);
  if (corner + 1 == corners_.size()) return middle + u * (middle - corners_[corner - 1]);
  const Joints before = middle - corners_[corner - 1], after = corners_[corner + 1] - middle;
  return middle + 0.5 * u * (before + after) + (0.5 * u * u + 0.125) * (after - before);
}

Joints Trajectory::at(double t) const {
  if (spans_.empty()) return corners_.front();
  const auto next =
      std::upper_bound(spans_.begin(), spans_.end(), t,
                       [](double time, const Span& span) { return time < span.begin; });
  if (next == spans_.begin()) return corners_.front();
  const Span& span = *(next - 1);
  const double in = std::min(t - span.begin, span.time);
  return on_path(span.from + span.speed * in + 0.5 * span.gain * in * in);
}

Path evened(const Ground& ground, const Path& path, double apart) {
  Path made{path.front()};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double far = ground.length(path[i - 1], path[i]);
    const int parts = std::max(1, static_cast<int>(std::ceil(far / apart)));
    for (int k = 1; k <= parts; ++k)
      made.push_back(path[i - 1] + static_cast<double>(k) / parts * (path[i] - path[i - 1]));
  }
  return made;
}

Path rounded(const Ground& ground, const Path& path, int width) {
  const auto count = static_cast<int>(path.size());
  const auto at = [&](const Path& of, int i) -> Joints {
    const auto k = [](int index) { return static_cast<std::size_t>(index); };
    if (i < 0) return 2 * of.front() - of[k(std::min(-i, count - 1))];
    if (i >= count) return 2 * of.back() - of[k(std::max(2 * (count - 1) - i, 0))];
    return of[k(i)];
  };
  const auto averaged = [&](const Path& of, int reach) {
    Path made;
    for (int i = 0; i < count; ++i) {
      Joints sum = at(of, i);
      for (int k = 1; k <= reach; ++k) sum += at(of, i - k) + at(of, i + k);
      made.push_back(sum / (2 * reach + 1));
    }
    made.front() = of.front();
    made.back() = of.back();
    return made;
  };
  for (int reach = width; reach > 0; reach /= 2) {
    Path made = averaged(averaged(path, reach), std::max(1, reach / 2));
    bool free = true;
    for (std::size_t i = 1; free && i < made.size(); ++i)
      free = ground.is_free(made[i - 1], made[i]);
    if (free) return made;
  }
  return path;
}

}  // namespace prehend::planning
