#include "services/glove/core/held_controller.hpp"

#include <algorithm>

namespace prehend::glove {

Landmarks hand_on(const HeldController& controller) {
  const auto [left, X_RG, trigger, grip] = controller;
  const model::HumanHand hand(1);
  const Landmarks open = landmarks_of(hand, model::HumanHand::open_posture());
  const Eigen::Vector3d palm = (open[0] + open[9]) / 2;  // between wrist and middle knuckle
  Landmarks points = landmarks_of(
      hand, model::HumanHand::posture({std::max(trigger, grip), trigger, grip, grip, grip}));
  for (Eigen::Vector3d& point : points) {
    const Eigen::Vector3d p = point - palm;  // fingers along x, thumb at y, back at z
    point = X_RG * Eigen::Vector3d(left ? -p.z() : p.z(), -p.x(), -p.y());
  }
  return points;
}

}  // namespace prehend::glove
