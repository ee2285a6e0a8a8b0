#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "common/base/pose.hpp"
#include "common/base/time.hpp"

namespace prehend::recorder::dataset {

/// What was told of one thing, in order of time.
template <class Value>
struct Series {
  std::vector<Time> times;  // increasing
  std::vector<Value> values;

  bool empty() const { return times.empty(); }
  /// What is not later than the last one is passed by.
  void add(Time time, Value value) {
    if (!times.empty() && time <= times.back()) return;
    times.push_back(time);
    values.push_back(std::move(value));
  }
};
using Numbers = Series<Eigen::VectorXd>;  // all of one size
using Poses = Series<Pose>;

/// A gap that is longer is not bridged: the older sample stands until the newer one.
inline constexpr Duration max_bridge = std::chrono::milliseconds(500);

/// Between which samples a moment lies, and how far (0 to 1) from the first to the second. Outside
/// of all: at the nearest one.
struct Between {
  std::size_t before = 0, after = 0;
  double share = 0;
};
/// There is at least one time.
Between between(const std::vector<Time>& times, Time t);

/// The last sample that was there by then; the first one where none was.
std::size_t newest(const std::vector<Time>& times, Time t);

/// Straight between two samples.
Eigen::VectorXd at(const Numbers& series, Time t);
/// Positions straight, orientations along the shortest arc at constant speed.
Pose at(const Poses& series, Time t);

}  // namespace prehend::recorder::dataset
