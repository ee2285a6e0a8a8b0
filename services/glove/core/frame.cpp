#include "services/glove/core/frame.hpp"

#include <algorithm>

#include "common/base/named_values.hpp"

namespace prehend::glove {

std::optional<model::Finger> finger_of(Site site) {
  switch (site) {
    case Site::thumb:
      return model::Finger::thumb;
    case Site::index:
      return model::Finger::index;
    case Site::middle:
      return model::Finger::middle;
    case Site::ring:
      return model::Finger::ring;
    case Site::little:
      return model::Finger::little;
    case Site::back_of_hand:
    case Site::forearm:
      break;
  }
  return std::nullopt;
}

bool is_identity_pose(const Reading& reading) {
  return reading.p_TS.norm() < 1e-9 && reading.q_TS.norm() > 1e-6 &&
         reading.q_TS.normalized().angularDistance(Eigen::Quaterniond::Identity()) < 1e-7;
}

Frame mirrored(Frame frame, const Eigen::Vector3d& normal_T) {
  // Both reflections are half turns times -1, and a half turn about a unit axis is the quaternion
  // (0, axis): the product is linear in q, so it need not be a rotation.
  const Eigen::Quaterniond across(0, normal_T.x(), normal_T.y(), normal_T.z()), about_y(0, 0, 1, 0);
  for (Reading& reading : frame.readings) {
    if (is_identity_pose(reading)) continue;
    reading.p_TS -= 2 * normal_T.dot(reading.p_TS) * normal_T;
    reading.q_TS = across * reading.q_TS * about_y;
  }
  frame.left = !frame.left;
  return frame;
}

Eigen::Vector3d left_to_right(const Pose& X_WT) {
  return X_WT.linear().transpose().col(0);
}

std::optional<Site> site_from_string(std::string_view name) {
  return site_names.value(name);
}

const std::vector<Site>& usual_sites() {
  static const std::vector<Site> sites{Site::back_of_hand, Site::thumb, Site::index, Site::little};
  return sites;
}

}  // namespace prehend::glove
