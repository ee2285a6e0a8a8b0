#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace prehend::proto {

/// A repeated field of numbers.
template <class Repeated>
Eigen::VectorXd to_vector(const Repeated& values) {
  Eigen::VectorXd vector(values.size());
  std::copy(values.begin(), values.end(), vector.begin());
  return vector;
}

}  // namespace prehend::proto
