#include "common/convert/convert.hpp"

namespace prehend::convert {

v1::Vector3 to_message(const Eigen::Vector3d& v) {
  v1::Vector3 message;
  message.x(v.x());
  message.y(v.y());
  message.z(v.z());
  return message;
}

v1::Pose to_message(const Pose& X) {
  const Eigen::Quaterniond q(X.linear());
  v1::Pose message;
  message.position(to_message(Eigen::Vector3d(X.translation())));
  message.orientation().w(q.w());
  message.orientation().x(q.x());
  message.orientation().y(q.y());
  message.orientation().z(q.z());
  return message;
}

Eigen::Vector3d from_message(const v1::Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

Expected<Pose> from_message(const v1::Pose& X) {
  const v1::Quaternion& q = X.orientation();
  return checked_pose(from_message(X.position()), Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()));
}

v1::ShapeKind to_message(model::ShapeKind kind) {
  switch (kind) {
    case model::ShapeKind::cylinder:
      return v1::SHAPE_CYLINDER;
    case model::ShapeKind::box:
      return v1::SHAPE_BOX;
    case model::ShapeKind::sphere:
      return v1::SHAPE_SPHERE;
    case model::ShapeKind::cone:
      return v1::SHAPE_CONE;
    case model::ShapeKind::unknown:
      break;
  }
  return v1::SHAPE_UNKNOWN;
}

model::ShapeKind from_message(v1::ShapeKind kind) {
  switch (kind) {
    case v1::SHAPE_CYLINDER:
      return model::ShapeKind::cylinder;
    case v1::SHAPE_BOX:
      return model::ShapeKind::box;
    case v1::SHAPE_SPHERE:
      return model::ShapeKind::sphere;
    case v1::SHAPE_CONE:
      return model::ShapeKind::cone;
    default:  // a newer sender may know more
      return model::ShapeKind::unknown;
  }
}

std::vector<double> to_message(const Eigen::VectorXd& v) {
  return std::vector<double>(v.data(), v.data() + v.size());
}

Eigen::VectorXd from_message(const std::vector<double>& v) {
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

}  // namespace prehend::convert
