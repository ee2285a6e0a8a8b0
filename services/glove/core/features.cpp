#include "services/glove/core/features.hpp"

namespace prehend::glove {

Eigen::Vector3d invariant_feature(const Pose& X_TR, const Eigen::Vector3d& p_TS) {
  return X_TR.linear().transpose() * (p_TS - X_TR.translation());
}

}  // namespace prehend::glove
