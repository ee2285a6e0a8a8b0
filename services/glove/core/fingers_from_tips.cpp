#include "services/glove/core/fingers_from_tips.hpp"

namespace prehend::glove {
namespace {

using Eigen::Vector3d;
using model::HumanPosture;
using Targets = std::array<std::optional<Vector3d>, model::finger_count>;

constexpr int iterations = 20;
constexpr double damping = 0.004;      // m/rad: a step of 0.1 rad must gain 0.4 mm
constexpr double near_enough = 0.001;  // m
constexpr double step = 1e-4;          // rad, of the numeric derivative

int first_dof(std::size_t finger) {
  return finger == 0 ? 16 : 4 * (static_cast<int>(finger) - 1);
}

HumanPosture descend(const model::HumanHand& hand, const Targets& p_HF, const HumanPosture& start) {
  HumanPosture q = hand.clamp(start);
  for (int n = 0; n < iterations; ++n) {
    const auto at = hand.fingertip_poses(q);
    // Each finger's joints move only its own tip, so one change for all fingers gives a column of
    // every finger's Jacobian.
    std::array<Eigen::Matrix<double, 3, 4>, model::finger_count> J;
    for (int j = 0; j < 4; ++j) {
      HumanPosture moved = q;
      for (std::size_t f = 0; f < p_HF.size(); ++f) moved[first_dof(f) + j] += step;
      const auto tips = hand.fingertip_poses(moved);
      for (std::size_t f = 0; f < p_HF.size(); ++f)
        J[f].col(j) = (tips[f].translation() - at[f].translation()) / step;
    }
    double largest = 0;
    for (std::size_t f = 0; f < p_HF.size(); ++f) {
      if (!p_HF[f]) continue;
      const Vector3d error = *p_HF[f] - at[f].translation();
      const Eigen::Matrix3d A =
          J[f] * J[f].transpose() + damping * damping * Eigen::Matrix3d::Identity();
      const Eigen::Vector4d change = J[f].transpose() * A.ldlt().solve(error);
      q.segment<4>(first_dof(f)) += change;
      largest = std::max(largest, change.cwiseAbs().maxCoeff());
    }
    q = hand.clamp(q);
    if (largest < 1e-4) break;
  }
  return q;
}

}  // namespace

HumanPosture fingers_from_tips(const model::HumanHand& hand, const Targets& p_HF,
                               const HumanPosture& start) {
  HumanPosture best = descend(hand, p_HF, start);
  // The limits of joints make hollows to get stuck in: whoever is not there tries other ways.
  Targets left = p_HF;
  for (const double closure : {0.0, 0.4, 0.8}) {
    const auto reached = hand.fingertip_poses(best);
    bool all = true;
    for (std::size_t f = 0; f < left.size(); ++f) {
      if (left[f] && (*left[f] - reached[f].translation()).norm() < near_enough) left[f].reset();
      all = all && !left[f];
    }
    if (all) break;
    std::array<double, model::finger_count> closures;
    closures.fill(closure);
    const HumanPosture other = descend(hand, left, model::HumanHand::posture(closures));
    const auto got = hand.fingertip_poses(other);
    for (std::size_t f = 0; f < left.size(); ++f)
      if (left[f] &&
          (*left[f] - got[f].translation()).norm() < (*left[f] - reached[f].translation()).norm())
        best.segment<4>(first_dof(f)) = other.segment<4>(first_dof(f));
  }
  return best;
}

}  // namespace prehend::glove
