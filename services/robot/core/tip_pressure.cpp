#include "services/robot/core/tip_pressure.hpp"

#include <Eigen/QR>
#include <cmath>

#include "common/model/hand_effort.hpp"

namespace prehend::robot {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double step = 1e-4;          // rad, of a derivative
constexpr double still = 0.1;          // rad/s, below which a DoF stands
constexpr double friction = 0.05;      // of a drive's whole effort
constexpr double min_pressure = 0.05;  // N, that counts as pressing
constexpr double min_way = 1e-4;       // m/rad: a tip that goes less is not moved

/// How each tip goes per unit of a DoF, towards closing.
std::vector<Vector3d> ways(const model::HandModel& hand, const VectorXd& dof, Eigen::Index d) {
  const model::HandDof& moved = hand.dofs()[static_cast<std::size_t>(d)];
  const double h = step * model::radian_of(moved);
  VectorXd there = dof, back = dof;
  there[d] += h;
  back[d] -= h;
  auto tips = hand.fingertip_positions(there);
  const auto before = hand.fingertip_positions(back);
  for (std::size_t k = 0; k < tips.size(); ++k)
    tips[k] = moved.closing * (tips[k] - before[k]) / (2 * h);
  return tips;
}

/// What a DoF presses with: N m or N.
double pressing_effort(const model::HandDof& dof, double effort, double velocity, double most) {
  const double closing = dof.closing * effort;
  const bool stands = std::abs(velocity) < still * model::radian_of(dof);
  return stands && closing > friction * most ? closing : 0;
}

}  // namespace

std::vector<TipPressure> tip_pressures(const model::HandModel& hand, const Reading& reading) {
  if (reading.effort.size() == 0) return {};
  const auto positions = hand.fingertip_positions(reading.dof);
  std::vector<TipPressure> tips(positions.size());
  const auto dofs = static_cast<Eigen::Index>(hand.dofs().size());
  const VectorXd most = model::max_effort(hand);
  std::vector<std::vector<Vector3d>> moved(hand.dofs().size());
  VectorXd effort = VectorXd::Zero(dofs);
  std::vector<Vector3d> all(tips.size(), Vector3d::Zero());
  for (Eigen::Index d = 0; d < dofs; ++d) {
    const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(d)];
    if (dof.closing == 0) continue;
    auto& of_dof = moved[static_cast<std::size_t>(d)] = ways(hand, reading.dof, d);
    for (std::size_t k = 0; k < tips.size(); ++k) all[k] += model::radian_of(dof) * of_dof[k];
    effort[d] = pressing_effort(dof, reading.effort[d], reading.velocity[d], most[d]);
  }
  MatrixXd lever = MatrixXd::Zero(dofs, static_cast<Eigen::Index>(tips.size()));
  for (std::size_t k = 0; k < tips.size(); ++k) {
    tips[k].p_BT = positions[k];
    tips[k].way_B = all[k].stableNormalized();
    if (all[k].norm() < min_way) continue;
    for (std::size_t d = 0; d < moved.size(); ++d)
      if (!moved[d].empty())
        lever(static_cast<Eigen::Index>(d), static_cast<Eigen::Index>(k)) =
            moved[d][k].dot(tips[k].way_B);
  }
  const VectorXd pressure = lever.completeOrthogonalDecomposition().solve(effort);
  for (std::size_t k = 0; k < tips.size(); ++k) {
    const double one = pressure[static_cast<Eigen::Index>(k)];
    tips[k].pressing = one > min_pressure;
    if (tips[k].pressing) tips[k].pressure = one;
  }
  return tips;
}

}  // namespace prehend::robot
