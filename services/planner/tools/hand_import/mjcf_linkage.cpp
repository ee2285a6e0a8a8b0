#include "services/planner/tools/hand_import/mjcf_linkage.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "services/planner/tools/hand_import/tree.hpp"

namespace prehend::planner {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using tinyxml2::XMLElement;

constexpr double closed_gap = 0.002;  // m, a loop that is
constexpr double unmoved = 1e-3;      // rad or m, over the whole way of a motor
constexpr int driver_samples = 9;     // of that way
constexpr int iterations = 100;       // of one sample
constexpr std::size_t solved_joints = 24, solved_drivers = 6, solved_loops = 12, solved_links = 128;
constexpr double arm_of_weld = 0.05;  // m, between points that hold two links by their turn

/// Values of passive joints that close loops, by Levenberg and Marquardt with stops: least energy
/// of the springs while stiff ones hold the loops.
class Linkage {
 public:
  Linkage(const std::vector<MjcfLoop>& loops, const MjcfTree& tree)
      : loops_(loops), robot_(tree.robot), ways_(tree.robot), joints_(tree.joints) {
    root_ = ways_.roots().at(0);
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) leaders_.push_back(leader_of(robot_, i));
    double stiffest = 1e-3;
    for (const auto& [name, joint] : joints_) stiffest = std::max(stiffest, joint.stiffness);
    hold_ = 1e6 * stiffest;
    for (const RobotJoint& joint : robot_.joints) rest_.push_back(ref_of(joint));
  }

  double ref_of(const RobotJoint& joint) const {
    const auto found = joints_.find(joint.name);
    const double ref = found == joints_.end() ? 0 : found->second.ref;
    return has_stops(joint) ? std::clamp(ref, joint.limit->lower, joint.limit->upper) : ref;
  }

  /// Joints that stand in a loop, without those between its base and the root.
  std::set<std::size_t> members() const {
    std::set<std::size_t> all;
    for (const MjcfLoop& loop : loops_) {
      const auto a = way_to(loop.first), b = way_to(loop.second);
      std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(),
                                    std::inserter(all, all.end()));
    }
    return all;
  }

  std::size_t leading(std::size_t joint) const {
    return leaders_[joint] ? leaders_[joint]->joint : joint;
  }

  void let_free(const std::vector<std::size_t>& passive) { passive_ = passive; }

  /// Values of the passive joints where a driven one stands at a value; from those at the last.
  VectorXd solve(std::size_t driver, double value, VectorXd q) const {
    std::vector<double> values = rest_;
    values[driver] = value;
    const VectorXd before = q;
    double damping = 1e-3 * hold_;
    double energy = energy_at(values, q, before);
    for (int k = 0; k < iterations; ++k) {
      const VectorXd step = step_at(values, q, before, damping);
      const VectorXd next = stopped(q + step);
      const double lower = energy_at(values, next, before);
      if (!(lower < energy)) {
        if (step.norm() < 1e-10 || damping > 1e12 * hold_) break;
        damping *= 8;
        continue;
      }
      q = next;
      energy = lower;
      damping = std::max(damping / 8, 1e-12 * hold_);
    }
    return q;
  }

  /// The greatest gap of a loop, m.
  double gap(std::size_t driver, double value, const VectorXd& q) const {
    std::vector<double> values = rest_;
    values[driver] = value;
    const VectorXd r = residual(values, q);
    double widest = 0;
    for (Eigen::Index i = 0; i + 2 < r.size(); i += 3)
      widest = std::max(widest, r.segment<3>(i).norm());
    return widest;
  }

  VectorXd at_rest() const {
    VectorXd q(static_cast<Eigen::Index>(passive_.size()));
    for (std::size_t i = 0; i < passive_.size(); ++i)
      q[static_cast<Eigen::Index>(i)] = rest_[passive_[i]];
    return q;
  }

 private:
  static bool has_stops(const RobotJoint& joint) {
    return joint.limit && joint.type != "continuous" && joint.limit->lower <= joint.limit->upper;
  }

  std::set<std::size_t> way_to(std::string link) const {
    std::set<std::size_t> way;
    for (bool found = true; found;) {
      found = false;
      for (std::size_t i = 0; i < robot_.joints.size() && !found; ++i)
        if (robot_.joints[i].child == link && way.insert(i).second) {
          link = robot_.joints[i].parent;
          found = true;
        }
    }
    return way;
  }

  VectorXd residual(std::vector<double> values, const VectorXd& q) const {
    for (std::size_t i = 0; i < passive_.size(); ++i)
      values[passive_[i]] = q[static_cast<Eigen::Index>(i)];
    for (std::size_t i = 0; i < values.size(); ++i)
      if (leaders_[i])
        values[i] = leaders_[i]->multiplier * values[leaders_[i]->joint] + leaders_[i]->offset;
    const auto X_BL = ways_.poses(root_, values);
    std::vector<double> all;
    for (const MjcfLoop& loop : loops_)
      for (const auto& [p, s] : loop.points) {
        const Vector3d apart = X_BL.at(loop.first) * p - X_BL.at(loop.second) * s;
        all.insert(all.end(), apart.begin(), apart.end());
      }
    return Eigen::Map<VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
  }

  const MjcfJoint* spring(std::size_t i) const {
    const auto found = joints_.find(robot_.joints[passive_[i]].name);
    return found == joints_.end() || !(found->second.stiffness > 0) ? nullptr : &found->second;
  }

  double energy_at(const std::vector<double>& values, const VectorXd& q,
                   const VectorXd& before) const {
    double energy = hold_ * residual(values, q).squaredNorm() + stay() * (q - before).squaredNorm();
    for (std::size_t i = 0; i < passive_.size(); ++i)
      if (const MjcfJoint* joint = spring(i)) {
        const double stretched = q[static_cast<Eigen::Index>(i)] - joint->springref;
        energy += joint->stiffness * stretched * stretched;
      }
    return energy;
  }

  double stay() const { return 1e-10 * hold_; }  // where nothing else tells

  VectorXd step_at(const std::vector<double>& values, const VectorXd& q, const VectorXd& before,
                   double damping) const {
    constexpr double h = 1e-6;
    const VectorXd r = residual(values, q);
    const Eigen::Index count = q.size();
    MatrixXd J(r.size(), count);
    for (Eigen::Index i = 0; i < count; ++i) {
      VectorXd beside = q;
      beside[i] += h;
      J.col(i) = (residual(values, beside) - r) / h;
    }
    VectorXd slope = hold_ * J.transpose() * r + stay() * (q - before);
    MatrixXd H = hold_ * J.transpose() * J;
    H.diagonal().array() += damping + stay();
    for (Eigen::Index i = 0; i < count; ++i)
      if (const MjcfJoint* joint = spring(static_cast<std::size_t>(i))) {
        slope[i] += joint->stiffness * (q[i] - joint->springref);
        H(i, i) += joint->stiffness;
      }
    for (Eigen::Index i = 0; i < count; ++i) {  // pressed against its stop
      const RobotJoint& joint = robot_.joints[passive_[static_cast<std::size_t>(i)]];
      if (!has_stops(joint)) continue;
      if (!(q[i] <= joint.limit->lower && slope[i] > 0) &&
          !(q[i] >= joint.limit->upper && slope[i] < 0))
        continue;
      H.row(i).setZero();
      H.col(i).setZero();
      H(i, i) = 1;
      slope[i] = 0;
    }
    const VectorXd step = -H.ldlt().solve(slope);
    const double most = step.cwiseAbs().maxCoeff();
    return most > 0.2 ? VectorXd(0.2 / most * step) : step;
  }

  VectorXd stopped(VectorXd q) const {
    for (std::size_t i = 0; i < passive_.size(); ++i) {
      const RobotJoint& joint = robot_.joints[passive_[i]];
      double& value = q[static_cast<Eigen::Index>(i)];
      if (has_stops(joint)) value = std::clamp(value, joint.limit->lower, joint.limit->upper);
    }
    return q;
  }

  const std::vector<MjcfLoop>& loops_;
  const Robot& robot_;
  const Tree ways_;
  const std::map<std::string, MjcfJoint>& joints_;
  std::string root_;
  std::vector<std::optional<Leader>> leaders_;
  std::vector<double> rest_;
  std::vector<std::size_t> passive_;
  double hold_ = 0;  // N/m
};

/// How passive joints follow one driven joint.
struct Following {
  VectorXd slope, offset, mean, moved;
};

std::optional<Following> follow_along(const Linkage& linkage, const Robot& robot,
                                      std::size_t driver) {
  const RobotJoint& joint = robot.joints[driver];
  const double rest = linkage.ref_of(joint);
  const bool limited = joint.limit && joint.limit->lower < joint.limit->upper;
  const double lower = limited ? joint.limit->lower : rest - 0.5;
  const double upper = limited ? joint.limit->upper : rest + 0.5;
  const VectorXd start = linkage.solve(driver, rest, linkage.at_rest());
  MatrixXd q(start.size(), driver_samples);
  VectorXd x(driver_samples);
  for (const double end : {lower, upper}) {
    VectorXd at = start;
    for (int k = 0; k <= driver_samples / 2; ++k) {
      const double value = rest + (end - rest) * k / (driver_samples / 2);
      at = linkage.solve(driver, value, at);
      if (linkage.gap(driver, value, at) > closed_gap || !at.allFinite()) return std::nullopt;
      const int column = driver_samples / 2 + (end == lower ? -k : k);
      x[column] = value;
      q.col(column) = at;
    }
  }
  const double mean = x.mean(), spread = (x.array() - mean).square().sum();
  Following found;
  found.slope = q * (x.array() - mean).matrix() / spread;
  found.mean = q.rowwise().mean();
  found.offset = found.mean - mean * found.slope;
  found.moved = q.rowwise().maxCoeff() - q.rowwise().minCoeff();
  if (!found.slope.allFinite() || !found.offset.allFinite()) return std::nullopt;
  return found;
}

}  // namespace

std::optional<MjcfLoop> read_loop(MjcfSource& source, const XMLElement& at, const MjcfTree& tree) {
  const MjcfElement element{&at, nullptr};
  MjcfLoop loop;
  Pose X_1, X_2;  // the frames that are held together, each in its link
  if (const auto first = element.own("site1"), second = element.own("site2"); first && second) {
    const auto a = tree.sites.find(*first), b = tree.sites.find(*second);
    if (a == tree.sites.end() || b == tree.sites.end()) return std::nullopt;
    std::tie(loop.first, X_1) = a->second;
    std::tie(loop.second, X_2) = b->second;
  } else {
    loop.first = element.own("body1").value_or("");
    loop.second = element.own("body2").value_or("");
    const auto a = tree.bodies.find(loop.first), b = tree.bodies.find(loop.second);
    if (a == tree.bodies.end() || b == tree.bodies.end()) return std::nullopt;
    std::vector<double> rest;  // as written
    for (const RobotJoint& joint : tree.robot.joints)
      rest.push_back(tree.joints.contains(joint.name) ? tree.joints.at(joint.name).ref : 0);
    const Tree ways(tree.robot);
    if (ways.roots().size() != 1) return std::nullopt;
    const auto X_BL = ways.poses(ways.roots()[0], rest);
    X_1 = a->second * make_pose(source.vector(element, "anchor", Vector3d::Zero()));
    if (!X_BL.contains(loop.first) || !X_BL.contains(loop.second)) return std::nullopt;
    X_2 = X_BL.at(loop.second).inverse() * X_BL.at(loop.first) * X_1;
  }
  if (loop.first == loop.second) return std::nullopt;
  const bool turns = std::string_view(at.Name()) == "connect";
  for (const Vector3d& p :
       {Vector3d(0, 0, 0), Vector3d(arm_of_weld, 0, 0), Vector3d(0, arm_of_weld, 0)})
    if (!turns || p.isZero()) loop.points.emplace_back(X_1 * p, X_2 * p);
  return loop;
}

bool close_linkages(const std::vector<MjcfLoop>& loops, const std::set<std::string>& driven,
                    MjcfTree& tree) {
  Robot& robot = tree.robot;
  if (loops.size() > solved_loops || robot.links.size() > solved_links ||
      Tree(robot).roots().size() != 1)
    return false;
  Linkage linkage(loops, tree);
  std::set<std::size_t> drivers, free;
  for (const std::size_t i : linkage.members()) {
    const std::size_t leader = linkage.leading(i);
    if (!robot.joints[leader].moves()) continue;
    (driven.contains(robot.joints[leader].name) ? drivers : free).insert(leader);
  }
  if (drivers.empty() || free.empty() || drivers.size() > solved_drivers ||
      free.size() > solved_joints)
    return false;
  const std::vector<std::size_t> passive(free.begin(), free.end());
  linkage.let_free(passive);
  std::vector<Following> ways;
  for (const std::size_t driver : drivers) {
    auto found = follow_along(linkage, robot, driver);
    if (!found) return false;
    ways.push_back(std::move(*found));
  }
  std::vector<std::optional<std::size_t>> leads(passive.size());  // which driver
  const auto stands = [&](std::size_t i) {
    return !leads[i] || std::abs(ways[*leads[i]].slope[static_cast<Eigen::Index>(i)]) <= unmoved;
  };
  for (std::size_t i = 0; i < passive.size(); ++i)
    for (std::size_t d = 0; d < ways.size(); ++d) {
      if (ways[d].moved[static_cast<Eigen::Index>(i)] < unmoved) continue;
      if (leads[i]) return false;  // two motors move it
      leads[i] = d;
    }
  for (std::size_t i = 0; i < passive.size(); ++i)
    for (const RobotJoint& joint : robot.joints)
      if (stands(i) && joint.mimic && joint.mimic->joint == robot.joints[passive[i]].name)
        return false;  // others would follow what is fixed
  for (std::size_t i = 0; i < passive.size(); ++i) {
    RobotJoint& joint = robot.joints[passive[i]];
    const auto row = static_cast<Eigen::Index>(i);
    const Following& way = ways[leads[i].value_or(0)];
    if (stands(i)) {
      joint.X_PJ = joint.X_PJ * motion(joint, way.mean[row]);
      joint.type = "fixed";
    } else {
      const std::size_t driver = *std::next(drivers.begin(), static_cast<long>(*leads[i]));
      joint.mimic = {robot.joints[driver].name, way.slope[row], way.offset[row]};
    }
  }
  return true;
}

}  // namespace prehend::planner
