#include "services/recorder/core/dataset/pose_columns.hpp"

namespace prehend::recorder::dataset {

std::vector<std::string> pose_columns(Turns turns) {
  if (turns == Turns::quaternion) return {"x", "y", "z", "qw", "qx", "qy", "qz"};
  return {"x", "y", "z", "r11", "r21", "r31", "r12", "r22", "r32"};
}

Eigen::VectorXd PoseWriter::numbers(const Pose& X) {
  Eigen::VectorXd all(turns_ == Turns::quaternion ? 7 : 9);
  all.head<3>() = X.translation();
  if (turns_ == Turns::columns) {
    all.segment<3>(3) = X.linear().col(0);
    all.segment<3>(6) = X.linear().col(1);
    return all;
  }
  const Eigen::Quaterniond q(X.linear());
  Eigen::Vector4d turn(q.w(), q.x(), q.y(), q.z());
  if (turn.dot(last_) < 0) turn = -turn;
  last_ = turn;
  all.tail<4>() = turn;
  return all;
}

}  // namespace prehend::recorder::dataset
