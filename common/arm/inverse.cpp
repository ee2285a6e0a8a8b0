#include "common/arm/inverse.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace prehend::arm {
namespace {

constexpr double accuracy = 1e-9;         // m and rad, of an answer
constexpr double same_branch = 1e-3;      // rad
constexpr std::size_t max_branches = 16;  // six joints that turn have no more
constexpr int max_steps = 60;
constexpr int judged_every = 6;   // steps, in which a search must get nearer by
constexpr double progress = 0.6;  // this factor at least
constexpr int redundant_count = 12;

/// The k-th number of the Halton sequence of a base, in [0, 1): evenly spread, always the same.
double halton(int k, int base) {
  double share = 1, value = 0;
  for (; k > 0; k /= base) {
    share /= base;
    value += share * (k % base);
  }
  return value;
}

constexpr int bases[] = {2, 3, 5, 7, 11, 13, 17};

Joints start_of(int k, Eigen::Index count) {
  Joints q(count);
  for (Eigen::Index i = 0; i < count; ++i)
    q[i] = (2 * halton(k + 1, bases[i]) - 1) * std::numbers::pi;
  return q;
}

bool is_new(const std::vector<Joints>& found, const Joints& q) {
  return std::none_of(found.begin(), found.end(), [&](const Joints& other) {
    double most = 0;
    for (Eigen::Index i = 0; i < q.size(); ++i)
      most = std::max(most, std::abs(wrapped(q[i] - other[i])));
    return most < same_branch;
  });
}

}  // namespace

Inverse::Inverse(const model::ArmModel& arm, const SearchOptions& options)
    : arm_(arm), options_(options), form_(puma_form(arm)) {}

std::vector<Joints> Inverse::solve(const model::ArmModel& six, const Pose& X_AE) const {
  std::vector<Joints> found =
      form_ ? solve_puma(six, *form_, X_AE, six.home) : search_branches(six, X_AE, options_);
  for (Joints& q : found) q = turned_into_limits(six, q);
  return found;
}

std::vector<Joints> Inverse::branches(const Pose& X_AE, double redundant) const {
  std::vector<Joints> found;
  for (const Joints& six : solve(locked(arm_, arm_.redundant, redundant), X_AE)) {
    Joints q(six.size() + 1);
    const Eigen::Index at = arm_.redundant;
    q << six.head(at), redundant, six.tail(six.size() - at);
    found.push_back(q);
  }
  order_by_limits(arm_, found);
  return found;
}

std::vector<Joints> Inverse::branches(const Pose& X_AE) const {
  std::vector<Joints> found;
  if (arm_.redundant < 0) {
    found = solve(arm_, X_AE);
  } else {
    for (const double value : redundant_values())
      for (const Joints& q : branches(X_AE, value)) found.push_back(q);
  }
  order_by_limits(arm_, found);
  return found;
}

std::vector<double> Inverse::redundant_values() const {
  std::vector<double> values;
  if (arm_.redundant < 0) return values;
  const model::ArmJoint& joint = arm_.joints[static_cast<std::size_t>(arm_.redundant)];
  for (int k = 0; k < redundant_count; ++k)
    values.push_back(joint.lower + (k + 0.5) / redundant_count * (joint.upper - joint.lower));
  return values;
}

std::vector<Joints> search_branches(const model::ArmModel& arm, const Pose& X_AE,
                                    const SearchOptions& options) {
  std::vector<Joints> found;
  if ((X_AE.translation() - arm.X_AS.translation()).norm() > reach_bound(arm)) return found;
  const auto count = static_cast<Eigen::Index>(arm.joints.size());
  int idle = 0;
  for (int k = 0; k < options.max_starts && idle < options.patience; ++k, ++idle) {
    auto q = refine(arm, X_AE, start_of(k, count));
    if (!q) continue;
    *q = q->unaryExpr([](double angle) { return wrapped(angle); });
    if (!is_new(found, *q)) continue;
    found.push_back(*q);
    if (found.size() == max_branches) break;
    idle = 0;
  }
  return found;
}

std::optional<Joints> refine(const model::ArmModel& arm, const Pose& X_AE, const Joints& start) {
  Joints q = start;
  double judged = 0;
  for (int step = 0; step < max_steps; ++step) {
    const Configuration at = forward(arm, q);
    const Vector6 way = way_between(at.X_AE, X_AE);
    const double far = way.norm();
    if (far < accuracy) return q;
    if (step % judged_every == 0) {
      if (step > 0 && far > progress * judged) return std::nullopt;
      judged = far;
    }
    const Jacobian J = jacobian(arm, at);
    // Damped by how far it still is [Sugihara 2011]: safe in singularities, fast at the end.
    using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, model::max_arm_joints,
                                 model::max_arm_joints>;
    Square H = J.transpose() * J;
    H.diagonal().array() += 0.5 * far * far + 1e-12;
    q += H.ldlt().solve(J.transpose() * way);
    if (!q.allFinite()) return std::nullopt;
  }
  return std::nullopt;
}

Joints start_within_limits(const model::ArmModel& arm, int k) {
  Joints q = start_of(k, static_cast<Eigen::Index>(arm.joints.size()));
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const model::ArmJoint& joint = arm.joints[static_cast<std::size_t>(i)];
    const double share = 0.5 * (1 + q[i] / std::numbers::pi);
    double lower = std::max(joint.lower, -std::numbers::pi),
           upper = std::min(joint.upper, std::numbers::pi);
    if (lower >= upper) {
      lower = joint.lower;
      upper = joint.upper;
    }
    q[i] = lower + share * (upper - lower);
  }
  return q;
}

Eigen::Vector3d evenly_spread(int k) {
  return {halton(k + 1, bases[0]), halton(k + 1, bases[1]), halton(k + 1, bases[2])};
}

model::ArmModel locked(const model::ArmModel& arm, int joint, double value) {
  model::ArmModel six = arm;
  const auto index = static_cast<std::size_t>(joint);
  const Pose X_PL = arm.joints[index].X_PJ * Eigen::AngleAxisd(value, arm.joints[index].axis_J);
  six.joints.erase(six.joints.begin() + joint);
  if (index < six.joints.size())
    six.joints[index].X_PJ = X_PL * six.joints[index].X_PJ;
  else
    six.X_LE = X_PL * six.X_LE;
  six.home.resize(arm.home.size() - 1);
  six.home << arm.home.head(joint), arm.home.tail(arm.home.size() - joint - 1);
  six.redundant = -1;
  six.links.clear();
  return six;
}

void order_by_limits(const model::ArmModel& arm, std::vector<Joints>& postures) {
  std::stable_partition(postures.begin(), postures.end(),
                        [&](const Joints& q) { return is_within_limits(arm, q); });
}

}  // namespace prehend::arm
