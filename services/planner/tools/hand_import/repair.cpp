#include "services/planner/tools/hand_import/repair.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "services/planner/tools/hand_import/locked.hpp"
#include "services/planner/tools/hand_import/tree.hpp"
#include "services/planner/tools/hand_import/units.hpp"

namespace prehend::planner {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double density = 1500;    // kg/m³, of links: plastic, metal and air
constexpr double min_mass = 0.005;  // kg
constexpr double rotor = 1e-4;      // kg m², of a motor behind the gear of a finger
constexpr double turning_effort = 1, turning_velocity = 2;     // N m, rad/s
constexpr double sliding_effort = 20, sliding_velocity = 0.1;  // N, m/s
// What motors of hands can do, at the fingertip or of a slide: many files give 0.01 or 1000 N m.
constexpr double weakest_tip = 4, strongest_tip = 10;       // N
constexpr double weakest_slide = 10, strongest_slide = 80;  // N
constexpr double low_effort = 0.15, high_effort = 0.4;      // N m, that any joint may have
constexpr double slowest_turn = 1, slowest_slide = 0.04;    // rad/s, m/s

Matrix3d point_inertia(double mass, const Vector3d& r) {
  return mass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
}

/// Mass and inertia of the shapes, filled evenly, each as the box around it; along the link's axes.
Inertial estimated(const std::vector<Solid>& solids, std::optional<double> given_mass) {
  double whole = 0;
  Vector3d middle = Vector3d::Zero();
  for (const Solid& solid : solids) {
    whole += model::volume(solid.shape);
    middle += model::volume(solid.shape) * solid.X_LS.translation();
  }
  Inertial inertial;
  inertial.mass = given_mass.value_or(std::max(density * whole, min_mass));
  inertial.X_LI.translation() = middle / whole;
  for (const Solid& solid : solids) {
    const double mass = inertial.mass * model::volume(solid.shape) / whole;
    const Vector3d square = (2 * model::half_extents(solid.shape)).cwiseAbs2();
    const Vector3d moments = mass / 12 * (Vector3d::Constant(square.sum()) - square);
    const Matrix3d R = solid.X_LS.linear();
    inertial.inertia_I += R * moments.asDiagonal() * R.transpose() +
                          point_inertia(mass, solid.X_LS.translation() - middle / whole);
  }
  return inertial;
}

bool is_possible(const Inertial& inertial) {
  const Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Matrix3d>(inertial.inertia_I, Eigen::EigenvaluesOnly)
          .eigenvalues();
  return moments[0] > 0 && moments[2] <= 1.001 * (moments[0] + moments[1]) &&
         std::sqrt(moments[2] / inertial.mass) < 0.6;
}

/// Two bodies as one, both in the frame of L.
Inertial joined(const Inertial& a, const Inertial& b) {
  Inertial sum;
  sum.mass = a.mass + b.mass;
  const Vector3d com = (a.mass * a.X_LI.translation() + b.mass * b.X_LI.translation()) / sum.mass;
  sum.X_LI.translation() = com;
  for (const Inertial* part : {&a, &b}) {
    const Matrix3d R = part->X_LI.linear();
    sum.inertia_I += R * part->inertia_I * R.transpose() +
                     point_inertia(part->mass, part->X_LI.translation() - com);
  }
  return sum;
}

std::string described(const model::Shape& shape) {
  const Vector3d mm = 1e3 * shape.size;
  if (shape.kind == model::ShapeKind::box)
    return fmt::format("a box of {:.0f} × {:.0f} × {:.0f} mm", mm.x(), mm.y(), mm.z());
  if (shape.kind == model::ShapeKind::cylinder)
    return fmt::format("a cylinder of radius {:.0f} and length {:.0f} mm", mm.x(), mm.z());
  return fmt::format("a sphere of radius {:.0f} mm", mm.x());
}

class Mender {
 public:
  Mender(const Robot& source, const MeshReader& meshes, const RobotKind& kind)
      : source_(without_locked(source, mended_.changes)), meshes_(meshes), kind_(kind) {}

  Expected<Mended> run() {
    mended_.robot.name = source_.name;
    if (auto joined_links = join_fixed(); !joined_links)
      return tl::unexpected(joined_links.error());
    for (RobotLink& link : mended_.robot.links) {
      if (link.collision.empty()) give_shape(link);
      give_mass(link);
    }
    for (RobotJoint& joint : mended_.robot.joints) give_limits(joint);
    agree_with_followers();
    if (!kind_.weak) return std::move(mended_);
    for (RobotLink& link : mended_.robot.links) give_rotor(link);
    const Tree tree(mended_.robot);
    const auto X_BL = tree.poses(tree.roots()[0], rest_values(mended_.robot));
    for (RobotJoint& joint : mended_.robot.joints) bound_effort(joint, tree, X_BL);
    return std::move(mended_);
  }

 private:
  void tell(std::string change) { mended_.changes.push_back(std::move(change)); }

  /// A solid as primitives; none for a visual that cannot be read.
  Expected<std::vector<Solid>> primitives(const RobotLink& link, const std::vector<Solid>& solids,
                                          bool visual) {
    std::vector<Solid> made;
    for (Solid solid : solids) {
      if (!solid.mesh.empty()) {
        auto points = meshes_(solid);
        if (!points && visual) continue;
        if (!points) return tl::unexpected(points.error());
        if (taken_as_millimetres(*points, kind_))
          tell(fmt::format("link {}: the mesh {} taken as millimetres", link.name, solid.mesh));
        const Solid fitted = fit_primitive(*points);
        tell(fmt::format("link {}: the mesh {} became {}", link.name, solid.mesh,
                         described(fitted.shape)));
        solid.shape = fitted.shape;
        solid.X_LS = solid.X_LS * fitted.X_LS;
        solid.mesh.clear();
      }
      if (is_valid(solid.shape)) made.push_back(solid);
    }
    return made;
  }

  /// Adds a link's mass and shapes to the body at `index`, in whose frame it stands at X_BL.
  Expected<void> add(const RobotLink& link, std::size_t index, const Pose& X_BL) {
    auto collision = primitives(link, link.collision, false);
    if (!collision) return tl::unexpected(collision.error());
    auto visual = link.collision.empty() ? primitives(link, link.visual, true)
                                         : Expected<std::vector<Solid>>(std::vector<Solid>());
    if (!visual->empty()) tell(fmt::format("link {}: collides as it looks", link.name));
    collision->insert(collision->end(), visual->begin(), visual->end());

    RobotLink& body = mended_.robot.links[index];
    std::optional<Inertial> inertial = link.inertial;
    if (inertial && !(inertial->mass > 0)) inertial.reset();  // a frame
    if (inertial && !is_possible(*inertial)) {
      if (collision->empty()) {
        inertial->inertia_I = 0.4 * inertial->mass * 1e-4 * Matrix3d::Identity();  // ball of 1 cm
      } else {
        inertial = estimated(*collision, inertial->mass);
      }
      tell(fmt::format("link {}: inertia of its shapes in place of an impossible one", link.name));
    }
    if (inertial) {
      inertial->X_LI = X_BL * inertial->X_LI;
      body.inertial = body.inertial ? joined(*body.inertial, *inertial) : *inertial;
    }
    for (Solid& solid : *collision) {
      solid.X_LS = X_BL * solid.X_LS;
      body.collision.push_back(solid);
    }
    return {};
  }

  Expected<void> join_fixed() {
    const Tree tree(source_);
    struct Place {
      std::size_t body;
      Pose X_BL;
    };
    std::map<std::string, Place> places;
    const auto begin_body = [&](const std::string& name) {
      mended_.robot.links.push_back({name, {}, {}, {}, 0});
      places[name] = {mended_.robot.links.size() - 1, Pose::Identity()};
    };
    const std::string& root = tree.roots()[0];
    begin_body(root);
    if (auto added = add(*source_.find_link(root), 0, Pose::Identity()); !added) return added;
    for (const std::size_t i : tree.below(root)) {
      RobotJoint joint = source_.joints[i];
      const Place parent = places.at(joint.parent);
      const Pose X_BJ = parent.X_BL * joint.X_PJ;
      if (joint.moves()) {
        begin_body(joint.child);
        joint.parent = mended_.robot.links[parent.body].name;
        joint.X_PJ = X_BJ;
        joint.axis_J.normalize();
        mended_.robot.joints.push_back(joint);
      } else {
        places[joint.child] = {parent.body, X_BJ};
        tell(fmt::format("link {}: joined to link {}", joint.child,
                         mended_.robot.links[parent.body].name));
      }
      const Place place = places.at(joint.child);
      if (auto added = add(*source_.find_link(joint.child), place.body, place.X_BL); !added)
        return added;
    }
    for (const auto& [link, finger] : source_.human)
      if (const auto place = places.find(link); place != places.end())
        mended_.robot.human[mended_.robot.links[place->second.body].name] = finger;
    return {};
  }

  /// Bars from the link's joint to those that it carries. A link that carries none and shows
  /// nothing becomes a short finger's end, along the bar that leads to it.
  void give_shape(RobotLink& link) {
    std::vector<Vector3d> ends;
    for (const RobotJoint& joint : mended_.robot.joints)
      if (joint.parent == link.name) ends.push_back(joint.X_PJ.translation());
    if (ends.empty())
      for (const RobotJoint& joint : mended_.robot.joints)
        if (joint.child == link.name && joint.X_PJ.translation().norm() > 1e-3)
          ends.push_back(0.02 *
                         (joint.X_PJ.linear().transpose() * joint.X_PJ.translation()).normalized());
    for (const Vector3d& end : ends) {
      if (end.norm() < 2e-3) continue;
      Solid bar;
      bar.shape = {model::ShapeKind::cylinder, {kind_.bone_radius, kind_.bone_radius, end.norm()}};
      bar.X_LS = make_pose(0.5 * end, Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), end));
      link.collision.push_back(bar);
    }
    if (!link.collision.empty())
      tell(fmt::format("link {}: has no shape, so it got a bar along its joints", link.name));
  }

  void give_mass(RobotLink& link) {
    if (link.inertial) return;
    if (link.collision.empty()) {
      Inertial small;  // the cross of a universal joint: a ball of 1 cm
      small.mass = 4 * min_mass;
      small.inertia_I = 0.4 * small.mass * 1e-4 * Matrix3d::Identity();
      link.inertial = small;
    } else {
      link.inertial = estimated(link.collision, std::nullopt);
    }
    tell(fmt::format("link {}: has no mass, {:.3f} kg estimated", link.name, link.inertial->mass));
  }

  void give_limits(RobotJoint& joint) {
    if (!joint.limit) joint.limit = JointLimit();
    JointLimit& limit = *joint.limit;
    if (joint.type == "continuous") {
      joint.type = "revolute";
      limit.lower = -std::numbers::pi;
      limit.upper = std::numbers::pi;
      tell(fmt::format("joint {}: turned without end, limited to ±π", joint.name));
    }
    if (!(limit.effort > 0)) {
      limit.effort = joint.slides() ? sliding_effort : turning_effort;
      tell(fmt::format("joint {}: effort of {} {} assumed", joint.name, limit.effort,
                       joint.slides() ? "N" : "N m"));
    }
    if (!(limit.velocity > 0)) {
      limit.velocity = joint.slides() ? sliding_velocity : turning_velocity;
      tell(fmt::format("joint {}: velocity of {} {} assumed", joint.name, limit.velocity,
                       joint.slides() ? "m/s" : "rad/s"));
    }
  }

  /// What leads goes no further than all that follow it may; those that would leave it less than
  /// half of its range are given more instead.
  void agree_with_followers() {
    for (std::size_t i = 0; i < mended_.robot.joints.size(); ++i) {
      const auto led = followed_range(mended_.robot, i);
      if (!led) continue;
      RobotJoint& joint = mended_.robot.joints[i];
      JointLimit& own = *joint.limit;
      const double low = std::max(led->first, own.lower), high = std::min(led->second, own.upper);
      if (low <= led->first && high >= led->second) continue;
      const Leader leader = *leader_of(mended_.robot, i);
      RobotJoint& leads = mended_.robot.joints[leader.joint];
      if (high - low < 0.5 * (led->second - led->first)) {
        own.lower = std::min(own.lower, led->first);
        own.upper = std::max(own.upper, led->second);
        tell(fmt::format("joint {}: may move from {:.3g} to {:.3g}, as {} leads it", joint.name,
                         own.lower, own.upper, leads.name));
        continue;
      }
      const auto [a, b] = std::minmax(
          {(low - leader.offset) / leader.multiplier, (high - leader.offset) / leader.multiplier});
      leads.limit->lower = std::max(leads.limit->lower, a);
      leads.limit->upper = std::min(leads.limit->upper, b);
      tell(fmt::format("joint {}: may move from {:.3g} to {:.3g}, as far as {} follows", leads.name,
                       leads.limit->lower, leads.limit->upper, joint.name));
    }
  }

  /// What a motor's rotor weighs behind its gear is more than a finger's link does; files tell the
  /// link alone. Without it a light link is thrown to and fro by whatever it touches.
  void give_rotor(RobotLink& link) {
    const bool moved =
        std::any_of(mended_.robot.joints.begin(), mended_.robot.joints.end(),
                    [&](const RobotJoint& joint) { return joint.child == link.name; });
    if (moved) link.inertial->inertia_I += rotor * Matrix3d::Identity();
  }

  /// From a joint to the farthest shape that it moves, at rest, m.
  double lever(const RobotJoint& joint, const Tree& tree,
               const std::map<std::string, Pose>& X_BL) const {
    double longest = 0;
    const Vector3d p_BJ = X_BL.at(joint.child).translation();
    std::vector<std::string> links{joint.child};
    for (const std::size_t i : tree.below(joint.child))
      links.push_back(mended_.robot.joints[i].child);
    for (const std::string& link : links)
      for (const Solid& solid : mended_.robot.find_link(link)->collision)
        longest = std::max(longest, (X_BL.at(link) * solid.X_LS.translation() - p_BJ).norm() +
                                        0.8 * model::half_extents(solid.shape).maxCoeff());
    return longest;
  }

  /// Efforts and velocities that no motor of a hand has crush or never close; bounded, and told.
  void bound_effort(RobotJoint& joint, const Tree& tree, const std::map<std::string, Pose>& X_BL) {
    JointLimit& limit = *joint.limit;
    const double arm = lever(joint, tree, X_BL);
    const double least = joint.slides() ? weakest_slide : std::max(low_effort, weakest_tip * arm);
    const double most =
        joint.slides() ? strongest_slide : std::max(high_effort, strongest_tip * arm);
    const double bounded = std::clamp(limit.effort, least, most);
    if (bounded != limit.effort)
      tell(fmt::format("joint {}: effort of {:.3g} taken as {:.3g} {}, as of a hand's motor",
                       joint.name, limit.effort, bounded, joint.slides() ? "N" : "N m"));
    limit.effort = bounded;
    const double slowest = joint.slides() ? slowest_slide : slowest_turn;
    if (limit.velocity < slowest) {
      tell(fmt::format("joint {}: velocity of {:.3g} taken as {:.3g} {}", joint.name,
                       limit.velocity, slowest, joint.slides() ? "m/s" : "rad/s"));
      limit.velocity = slowest;
    }
  }

  Mended mended_;
  const Robot source_;
  const MeshReader& meshes_;
  const RobotKind kind_;
};

}  // namespace

Expected<Mended> repair(const Robot& robot, const MeshReader& meshes, const RobotKind& kind) {
  return Mender(robot, meshes, kind).run();
}

}  // namespace prehend::planner
