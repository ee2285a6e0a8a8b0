#include "services/glove/core/calibration/hand_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/base/named_values.hpp"
#include "services/glove/core/joint_sensors.hpp"

namespace prehend::glove {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::size_t poses = shown_poses.size();

// Places of the unknowns: logarithms of the lengths, mounting of the back-of-hand sensor, angles.
constexpr Index scale_at = 0, fingers_at = 1, turn_at = 6, shift_at = 9, angles_at = 12;
constexpr Index unknowns = angles_at + static_cast<Index>(poses) * model::human_dof_count;

// What people and their gloves differ by (standard deviations).
constexpr double scale_sigma = 0.12;    // of adults and children; logarithm
constexpr double finger_sigma = 0.05;   // of one finger beside the hand's (Chatzioglou et al. 2024)
constexpr double turn_sigma = 0.02;     // rad, crooked sensor on the back of the hand
constexpr double shift_sigma = 0.003;   // m, its place
constexpr double angle_sigma = 0.12;    // rad, of a joint from what was asked for
constexpr double tip_sigma = 0.003;     // m, a sensor from the fingertip
constexpr double max_residual = 0.012;  // m, what none of this explains

VectorXd spreads() {
  VectorXd sigma(unknowns);
  sigma[scale_at] = scale_sigma;
  sigma.segment(fingers_at, 5).setConstant(finger_sigma);
  sigma.segment(turn_at, 3).setConstant(turn_sigma);
  sigma.segment(shift_at, 3).setConstant(shift_sigma);
  sigma.tail(unknowns - angles_at).setConstant(angle_sigma);
  return sigma;
}

model::HumanHand hand_of(const VectorXd& x) {
  std::array<double, model::finger_count> fingers{};
  for (std::size_t f = 0; f < fingers.size(); ++f)
    fingers[f] = std::exp(x[fingers_at + static_cast<Index>(f)]);
  return model::HumanHand(std::exp(x[scale_at]), fingers);
}

/// Unexplained parts of the fingertips, m; x holds deviations from what is expected.
VectorXd unexplained(const VectorXd& x, const std::array<Fingertips, poses>& shown) {
  const model::HumanHand hand = hand_of(x);
  const Vector3d turn = x.segment<3>(turn_at);
  const Eigen::AngleAxisd R_RH(
      turn.norm(), turn.norm() > 1e-12 ? Vector3d(turn.normalized()) : Vector3d::UnitX());
  VectorXd residual(3 * static_cast<Index>(poses) * model::finger_count);
  Index row = 0;
  for (std::size_t pose = 0; pose < poses; ++pose) {
    const model::HumanPosture q =
        posture_of(shown_poses[pose]) +
        x.segment<model::human_dof_count>(angles_at +
                                          static_cast<Index>(pose) * model::human_dof_count);
    const auto tips = hand.fingertip_poses(q);
    for (std::size_t f = 0; f < tips.size(); ++f)
      if (shown[pose][f].valid) {
        residual.segment<3>(row) =
            shown[pose][f].p_HF - R_RH * tips[f].translation() - x.segment<3>(shift_at);
        row += 3;
      }
  }
  return residual.head(row);
}

double thumb_to_index(const Fingertips& tips) {
  return tips[0].valid && tips[1].valid ? (tips[0].p_HF - tips[1].p_HF).norm() : NAN;
}

/// With what to tell the person.
constexpr auto pose_names = named_values<ShownPose>(
    {{ShownPose::open, "open hand",
      "open the hand: fingers straight, a little apart, the thumb away from them"},
     {ShownPose::fist, "fist", "make a fist: the thumb across the fingers"},
     {ShownPose::pinch, "pinch",
      "pinch: thumb and index finger touch, the other fingers half bent"}});
static_assert(pose_names.size() == shown_poses.size());

}  // namespace

std::string_view to_string(ShownPose pose) {
  return pose_names.name(pose);
}

std::string_view instruction(ShownPose pose) {
  for (const auto& row : pose_names)
    if (row.value == pose) return row.help;
  return "";
}

model::HumanPosture posture_of(ShownPose pose) {
  switch (pose) {
    case ShownPose::open:
      return model::HumanHand::open_posture();
    case ShownPose::fist:
      return model::HumanHand::fist_posture();
    case ShownPose::pinch:
      break;
  }
  return pinch_posture();
}

Expected<void> check_pose(ShownPose pose, const Fingertips& tips, const Fingertips& open) {
  // Sensors on two nails are up to 4 cm apart when the pads meet. Tips along x of the hand: a small
  // hand's stretched fingers reach further than a big one's fist, and half-bent fingers are no
  // fist.
  constexpr double stretched = 0.075, open_gap = 0.05, pinched = 0.045;  // m
  constexpr double bent = 0.4;  // of where the stretched finger's tip was
  bool shown = true;
  if (pose == ShownPose::open) shown = !(thumb_to_index(tips) < open_gap);
  if (pose == ShownPose::pinch) shown = !(thumb_to_index(tips) > pinched);
  for (std::size_t f = 1; f < tips.size(); ++f) {
    if (!tips[f].valid) continue;
    if (pose == ShownPose::open && tips[f].p_HF.x() < stretched) shown = false;
    if (pose == ShownPose::pinch && f == 1 && tips[f].p_HF.x() < bent / 2 * open[f].p_HF.x())
      shown = false;
    if (pose == ShownPose::fist && open[f].valid && tips[f].p_HF.x() > bent * open[f].p_HF.x())
      shown = false;
  }
  if (shown) return {};
  return fail(fmt::format("this is no {}", to_string(pose)), {}, std::string(instruction(pose)));
}

Expected<HandFit> fit_hand(const std::array<Fingertips, poses>& shown) {
  for (std::size_t pose = 0; pose < poses; ++pose) {
    const auto valid = std::count_if(shown[pose].begin(), shown[pose].end(),
                                     [](const Fingertip& tip) { return tip.valid; });
    if (valid < 3)
      return fail(fmt::format("{} of 3 fingertips were seen", valid),
                  std::string(to_string(shown_poses[pose])),
                  "calibration by poses needs sensors on three fingers");
  }
  const VectorXd sigma = spreads();
  VectorXd x = VectorXd::Zero(unknowns);
  MatrixXd normal;
  VectorXd residual = unexplained(x, shown);
  constexpr int rounds = 15;
  for (int round = 0; round < rounds; ++round) {
    MatrixXd J(residual.size(), unknowns);
    for (Index i = 0; i < unknowns; ++i) {
      constexpr double step = 1e-6;
      VectorXd moved = x;
      moved[i] += step;
      J.col(i) = (unexplained(moved, shown) - residual) / step;
    }
    normal = J.transpose() * J / (tip_sigma * tip_sigma);
    normal.diagonal() += sigma.cwiseAbs2().cwiseInverse();
    const VectorXd gradient =
        J.transpose() * residual / (tip_sigma * tip_sigma) + x.cwiseQuotient(sigma.cwiseAbs2());
    const VectorXd change = normal.ldlt().solve(gradient);
    x -= change;
    x[scale_at] = std::clamp(x[scale_at], std::log(0.7), std::log(1.4));
    residual = unexplained(x, shown);
    if (change.cwiseQuotient(sigma).norm() < 1e-4) break;
  }
  HandFit fit;
  fit.scale = std::exp(x[scale_at]);
  for (std::size_t f = 0; f < fit.fingers.size(); ++f)
    fit.fingers[f] = std::exp(x[fingers_at + static_cast<Index>(f)]);
  const VectorXd unit = VectorXd::Unit(unknowns, scale_at);
  fit.scale_sd = fit.scale * std::sqrt(normal.ldlt().solve(unit)[scale_at]);
  fit.residual = residual.norm() / std::sqrt(static_cast<double>(residual.size()) / 3);
  if (!std::isfinite(fit.scale) || !(fit.residual < max_residual))
    return fail(
        fmt::format("no hand explains these poses, they are {:.0f} mm off", 1000 * fit.residual),
        "calibration", "check where the sensors sit, and show the poses again");
  return fit;
}

}  // namespace prehend::glove
