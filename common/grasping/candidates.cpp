#include "common/grasping/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/base/random.hpp"
#include "common/grasping/preshapes.hpp"

namespace prehend::grasping {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double tilt = 0.15;        // rad, sigma of the error of the approach
constexpr double tilted = 0.5;       // share of candidates that have one
constexpr double to_the_end = 0.35;  // share that comes as near as it can
constexpr double deepest = 0.02;     // m, that the others may go beyond the usual depth
constexpr double shallowest = 0.03;  // m, that they may stay before it
constexpr double half_closed = 0.3;  // share in which the closing DoFs begin closed, up to
constexpr double max_closed = 0.4;   // this share of their range

/// Independent streams from neighbouring numbers (the finaliser of splitmix64).
std::uint64_t mixed(std::uint64_t seed, std::uint64_t index) {
  std::uint64_t z = seed * 0x9e3779b97f4a7c15u + index + 1;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/// Approached along the axis `along`, closed on across the axis `across`.
struct Way {
  int along, across;
};

std::vector<Way> ways(const Vector3d& half, double opening) {
  std::vector<Way> all, fitting;
  for (int along = 0; along < 3; ++along)
    for (int across = 0; across < 3; ++across) {
      if (along == across) continue;
      all.push_back({along, across});
      if (2 * half[across] <= opening) fitting.push_back({along, across});
    }
  return fitting.empty() ? all : fitting;
}

/// A turn that leaves the shape as it is.
Matrix3d symmetry(const model::Shape& shape, Random& random) {
  const double angle = random.uniform(0, 2 * std::numbers::pi);
  if (model::is_upright_round(shape.kind))
    return Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix();
  if (shape.kind != model::ShapeKind::sphere) return Matrix3d::Identity();
  const Vector3d axis = random.normal3(1);
  return Eigen::AngleAxisd(angle, axis.stableNormalized()).toRotationMatrix();
}

VectorXd sample_preshape(const model::HandModel& hand, const VectorXd& posture, double off_posture,
                         Random& random) {
  VectorXd dof = posture;
  const bool sampled = random.uniform() < off_posture;
  const double closed = random.uniform() < half_closed ? random.uniform(0, max_closed) : 0;
  for (Eigen::Index i = 0; i < dof.size(); ++i) {
    const model::HandDof& limits = hand.dofs()[static_cast<std::size_t>(i)];
    const double place = random.uniform();  // drawn for every DoF, used or not
    if (limits.closing == 0) {
      // Two draws' mean: values in the middle are of use more often than those at the limits.
      const double middle = 0.5 * (place + random.uniform());
      if (sampled) dof[i] = limits.lower + middle * (limits.upper - limits.lower);
    } else {
      const double end = limits.closing > 0 ? limits.upper : limits.lower;
      dof[i] += closed * (end - dof[i]);
    }
  }
  return hand.clamp(dof);
}

}  // namespace

double narrowest_width(const model::Shape& shape) {
  return 2 * model::half_extents(shape).minCoeff();
}

Candidate sample_candidate(const model::HandModel& hand, const model::Shape& shape,
                           std::uint64_t seed, int index, double off_posture) {
  Random random(mixed(seed, static_cast<std::uint64_t>(index)));
  const Vector3d half = model::half_extents(shape);
  const std::vector<Way> choices = ways(half, hand.reach().opening);
  const Way way = choices[random.index(choices.size())];
  const double from = random.uniform() < 0.5 ? 1 : -1, to = random.uniform() < 0.5 ? 1 : -1;

  // The origin of G: below the surface that is approached, not far from the middle of the side.
  Vector3d p = Vector3d::Zero();
  p[way.along] = -from * std::max(0.0, half[way.along] - hand.reach().engage);
  const int beside = 3 - way.along - way.across;
  p[beside] = half[beside] * (random.uniform() + random.uniform() - 1);
  Matrix3d R = model::grasp_axes(from * Vector3d::Unit(way.along), to * Vector3d::Unit(way.across));
  const Vector3d error = random.normal3(tilt);
  if (random.uniform() < tilted && error.norm() > 1e-9)
    R = Eigen::AngleAxisd(error.norm(), error.normalized()).toRotationMatrix() * R;
  const Matrix3d turn = symmetry(shape, random);

  Candidate candidate;
  const double stand_off = random.uniform(-shallowest, deepest);
  if (random.uniform() < to_the_end)
    candidate.press_on = half.maxCoeff();
  else
    p += stand_off * R.col(2);
  candidate.X_OG = make_pose(turn * p, turn * R);
  const std::vector<std::string> postures = opened_postures(hand);
  candidate.posture = postures[random.index(postures.size())];
  candidate.preshape =
      sample_preshape(hand, hand.postures().at(candidate.posture), off_posture, random);
  return candidate;
}

}  // namespace prehend::grasping
