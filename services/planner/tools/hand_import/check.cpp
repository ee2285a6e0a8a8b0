#include "services/planner/tools/hand_import/check.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "services/planner/tools/hand_import/locked.hpp"
#include "services/planner/tools/hand_import/overlap.hpp"
#include "services/planner/tools/hand_import/tree.hpp"
#include "services/planner/tools/hand_import/units.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;

constexpr double deep = 0.003;   // m, overlap of links at rest
constexpr double beyond = 1e-3;  // rad or m, of a limit that is rounded
constexpr std::size_t max_links = 256;

class Checker {
 public:
  Checker(const Robot& robot, const MeshReader& meshes, const RobotKind& kind)
      : robot_(robot), meshes_(meshes), kind_(kind), tree_(robot), findings_(robot.findings) {}

  std::vector<UrdfFinding> run() {
    for (const RobotLink& link : robot_.links) check_link(link);
    for (const RobotJoint& joint : robot_.joints) check_joint(joint);
    check_mimics();
    if (check_tree()) {
      check_fingers();
      check_masses();
      check_rest();
    }
    std::stable_sort(findings_.begin(), findings_.end(),
                     [](const UrdfFinding& a, const UrdfFinding& b) {
                       return a.severity == Severity::error && b.severity != Severity::error;
                     });
    return std::move(findings_);
  }

 private:
  void error(const char* code, std::string element, int line, std::string what,
             std::string repair) {
    findings_.push_back(
        {Severity::error, code, std::move(element), line, std::move(what), std::move(repair)});
  }
  void warning(const char* code, std::string element, int line, std::string what,
               std::string repair) {
    findings_.push_back(
        {Severity::warning, code, std::move(element), line, std::move(what), std::move(repair)});
  }

  void check_link(const RobotLink& link) {
    const std::string name = "link " + link.name;
    if (link.inertial) check_inertial(*link.inertial, name, link.line);
    for (const Solid& solid : link.collision) {
      if (solid.mesh.empty())
        check_size(model::half_extents(solid.shape), solid.X_LS, name, solid.line);
      else
        check_mesh(solid, name, true);
    }
    for (const Solid& solid : link.visual)
      if (link.collision.empty() && !solid.mesh.empty()) check_mesh(solid, name, false);
  }

  void check_mesh(const Solid& solid, const std::string& name, bool collides) {
    auto points = meshes_(solid);
    if (!points) {
      const std::string what =
          fmt::format("{} mesh: {}", collides ? "collision" : "visual", points.error().message());
      if (collides)
        error("missing-mesh", name, solid.line, what, "or use a box, cylinder or sphere");
      else
        warning("missing-mesh", name, solid.line, what,
                "without it the link gets a shape along its joints");
      return;
    }
    if (taken_as_millimetres(*points, kind_))
      warning("units", name, solid.line, fmt::format("the mesh {} is metres large", solid.mesh),
              "`add` takes it as millimetres; scale=\"0.001 0.001 0.001\" says so");
    const Solid fitted = fit_primitive(*points);
    check_size(model::half_extents(fitted.shape), solid.X_LS * fitted.X_LS, name, solid.line);
    if (collides)
      warning("mesh-collision", name, solid.line,
              fmt::format("collides as the mesh {}", solid.mesh),
              "`add` fits a box, cylinder or sphere to it");
  }

  void check_size(const Vector3d& half, const Pose& X_LS, const std::string& name, int line) {
    if (half.maxCoeff() > 0.5 * kind_.max_link || X_LS.translation().norm() > kind_.max_link)
      error("units", name, line,
            fmt::format("a shape of {:.3g} m, {:.3g} m from its link", 2 * half.maxCoeff(),
                        X_LS.translation().norm()),
            "URDF is in metres; these look like millimetres");
  }

  void check_inertial(const Inertial& inertial, const std::string& name, int line) {
    const double mass = inertial.mass;
    if (mass == 0) {
      warning("no-mass", name, line, "weighs nothing, as a frame does",
              "`add` estimates what moves from the shapes");
      return;
    }
    if (!(mass > 0)) {
      error("no-mass", name, line, fmt::format("has a mass of {} kg", mass),
            "give its mass in kg, or leave <inertial> out to have it estimated");
      return;
    }
    if (mass > kind_.max_mass)
      error("units", name, line, fmt::format("weighs {:.3g} kg", mass),
            "masses are in kg; this looks like grams");
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertial.inertia_I,
                                                                Eigen::EigenvaluesOnly);
    const Vector3d moments = solver.eigenvalues();
    // A body has no moment greater than the sum of the two others.
    if (!(moments[0] > 0) || moments[2] > 1.001 * (moments[0] + moments[1])) {
      warning("impossible-inertia", name, line,
              fmt::format("no body has the principal moments {:.3g}, {:.3g}, {:.3g} kg m²",
                          moments[0], moments[1], moments[2]),
              "`add` puts those of its shapes in their place");
    } else if (std::sqrt(moments[2] / mass) > kind_.max_link) {
      warning("impossible-inertia", name, line,
              fmt::format("moments of {:.3g} kg m² need a body of {:.2g} m", moments[2],
                          2 * std::sqrt(moments[2] / mass)),
              "inertia is in kg m²; `add` puts that of its shapes in its place");
    }
  }

  void check_joint(const RobotJoint& joint) {
    const std::string name = "joint " + joint.name;
    static const std::set<std::string> known{"revolute", "prismatic", "fixed", "continuous"};
    if (!known.contains(joint.type)) {
      error("joint-type", name, joint.line, fmt::format("is of the type \"{}\"", joint.type),
            "use revolute, prismatic and fixed joints; several in place of one of many axes");
      return;
    }
    for (const std::string& link : {joint.parent, joint.child})
      if (!link.empty() && !robot_.find_link(link))
        error("missing-link", name, joint.line, fmt::format("there is no link {}", link),
              "spell it as its <link>");
    if (joint.X_PJ.translation().norm() > kind_.max_link)
      error("units", name, joint.line,
            fmt::format("stands {:.3g} m from its parent", joint.X_PJ.translation().norm()),
            "URDF is in metres; these look like millimetres");
    if (!joint.moves()) return;
    if (!(joint.axis_J.norm() > 1e-6))
      error("zero-axis", name, joint.line, "its axis has no direction", "<axis xyz=\"…\"/>");
    if (joint.type == "continuous") {
      warning("continuous", name, joint.line, "turns without end",
              "`add` limits it to ±π; make it revolute with its real limits");
      return;
    }
    if (!joint.limit) {
      error("no-limits", name, joint.line, "has no limits", "<limit lower upper effort velocity/>");
      return;
    }
    const JointLimit& limit = *joint.limit;
    if (!limit.has_range)
      error("no-limits", name, joint.line, "the range is missing: no lower and no upper limit",
            "<limit lower=\"…\" upper=\"…\" …/>");
    else if (is_locked(joint))
      warning("locked", name, joint.line, fmt::format("may move from {0} to {0}", limit.lower),
              "`add` holds it there");
    else if (!(limit.lower < limit.upper))
      error("no-limits", name, joint.line,
            fmt::format("may move from {} to {}", limit.lower, limit.upper),
            "lower < upper; make it fixed if it does not move");
    if (joint.slides() && limit.upper - limit.lower > kind_.max_link)
      error("units", name, joint.line, fmt::format("slides {:.3g} m", limit.upper - limit.lower),
            "URDF is in metres; these look like millimetres");
    if (!joint.slides() && limit.upper - limit.lower > 13)
      error("units", name, joint.line, fmt::format("turns {:.3g} rad", limit.upper - limit.lower),
            "angles are in radians; these look like degrees");
    if (!(limit.effort > 0))
      warning("no-effort", name, joint.line, "has no effort limit", "`add` assumes one");
    if (!(limit.velocity > 0))
      warning("no-velocity", name, joint.line, "has no velocity limit", "`add` assumes one");
  }

  void check_mimics() {
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
      const RobotJoint& joint = robot_.joints[i];
      const std::string name = "joint " + joint.name;
      if (!joint.mimic || !joint.moves()) continue;
      const RobotJoint* master = robot_.find_joint(joint.mimic->joint);
      if (!master)
        error("mimic-missing", name, joint.line,
              fmt::format("follows joint {}, which is not there", joint.mimic->joint),
              "name a joint of this file");
      else if (!master->moves())
        warning("locked", name, joint.line,
                fmt::format("follows joint {}, which is fixed", master->name),
                "`add` holds it where that one is");
      else if (!leader_of(robot_, i))
        error("mimic-loop", name, joint.line, "follows joints that follow each other, or nothing",
              "one joint of the loop must lead");
      if (joint.mimic->multiplier == 0)
        warning("locked", name, joint.line, "follows with the factor 0",
                "`add` holds it where it is");
      check_follows(i, name);
    }
  }

  /// What its leader may do, this joint may do.
  void check_follows(std::size_t i, const std::string& name) {
    const RobotJoint& joint = robot_.joints[i];
    const auto range = followed_range(robot_, i);
    if (!range || !joint.limit || !joint.limit->has_range) return;
    const JointLimit& own = *joint.limit;
    if (range->first >= own.lower - beyond && range->second <= own.upper + beyond) return;
    warning("mimic-limit", name, joint.line,
            fmt::format("is led from {:.3g} to {:.3g}, and may move from {:.3g} to {:.3g}",
                        range->first, range->second, own.lower, own.upper),
            "`add` narrows the range of what leads it, or widens this one if little would be left");
  }

  /// True if the links form one tree in which something moves, so that poses mean something.
  bool check_tree() {
    if (robot_.links.empty()) {
      error("no-links", "robot " + robot_.name, 0, "has no links", "a hand has a palm and fingers");
      return false;
    }
    if (robot_.links.size() > max_links) {
      error("no-links", "robot " + robot_.name, 0, fmt::format("has {} links", robot_.links.size()),
            "cut the hand out of the robot");
      return false;
    }
    bool good = true;
    std::map<std::string, int> parents;
    for (const RobotJoint& joint : robot_.joints)
      if (++parents[joint.child] == 2) {
        error("two-parents", "link " + joint.child, joint.line, "hangs on two joints",
              "links form a tree; close loops by <mimic>");
        good = false;
      }
    const auto& roots = tree_.roots();
    if (roots.empty()) {
      error("joint-loop", "robot " + robot_.name, 0, "every link hangs on another",
            "one link is the base");
      return false;
    }
    if (roots.size() > 1) {
      std::string names;
      for (const std::string& root : roots) names += (names.empty() ? "" : ", ") + root;
      error("several-roots", "robot " + robot_.name, 0,
            fmt::format("these links hang on nothing: {}", names),
            "join them by joints; only the base hangs on nothing");
      good = false;
    }
    std::set<std::string> reached(roots.begin(), roots.end());
    for (const std::string& root : roots)
      for (const std::size_t joint : tree_.below(root)) reached.insert(robot_.joints[joint].child);
    for (const RobotLink& link : robot_.links)
      if (!reached.contains(link.name)) {
        error("joint-loop", "link " + link.name, link.line, "hangs on itself through its joints",
              "links form a tree");
        good = false;
      }
    return good;
  }

  /// The name of the link that a link is fixed to, after all.
  std::map<std::string, std::string> bodies() const {
    std::map<std::string, std::string> body;
    const std::string& root = tree_.roots()[0];
    body[root] = root;
    for (const std::size_t i : tree_.below(root)) {
      const RobotJoint& joint = robot_.joints[i];
      body[joint.child] = joint.moves() ? joint.child : body[joint.parent];
    }
    return body;
  }

  void check_fingers() {
    std::vector<std::string> ignored;
    const Robot free = without_locked(robot_, ignored);
    const bool moves = std::any_of(free.joints.begin(), free.joints.end(),
                                   [](const RobotJoint& joint) { return joint.moves(); });
    if (!moves)
      error("no-fingertips", "robot " + robot_.name, 0, "no joint moves, so there are no fingers",
            "a finger is a chain of moving links that ends somewhere");
  }

  void check_masses() {
    std::map<std::string, bool> massive, solid;
    const auto body = bodies();
    for (const RobotLink& link : robot_.links) {
      const std::string& of = body.at(link.name);
      massive[of] = massive[of] || link.inertial;
      solid[of] = solid[of] || !link.collision.empty();
    }
    for (const auto& [name, has] : massive) {
      if (!has)
        warning("no-inertial", "link " + name, robot_.find_link(name)->line, "has no mass",
                "`add` estimates it from the shapes");
      if (!solid[name])
        warning("no-collision", "link " + name, robot_.find_link(name)->line,
                "has no collision shape", "`add` makes one from its visuals or its length");
    }
  }

  void check_rest() {
    const auto body = bodies();
    const auto X_BL = tree_.poses(tree_.roots()[0], rest_values(robot_));
    std::set<std::pair<std::string, std::string>> neighbours, told;
    for (const RobotJoint& joint : robot_.joints)
      if (joint.moves()) neighbours.insert(std::minmax(body.at(joint.parent), joint.child));
    for (std::size_t i = 0; i < robot_.links.size(); ++i)
      for (std::size_t j = i + 1; j < robot_.links.size(); ++j) {
        const RobotLink &a = robot_.links[i], &b = robot_.links[j];
        const auto pair = std::minmax(body.at(a.name), body.at(b.name));
        if (pair.first == pair.second || neighbours.contains(pair) || told.contains(pair)) continue;
        double depth = 0;
        for (const Solid& s : a.collision)
          for (const Solid& t : b.collision)
            if (is_valid(s.shape) && is_valid(t.shape))
              depth = std::max(depth, overlap(s.shape, X_BL.at(a.name) * s.X_LS, t.shape,
                                              X_BL.at(b.name) * t.X_LS));
        if (depth < deep) continue;
        told.insert(pair);
        warning("self-collision", "link " + b.name, b.line,
                fmt::format("is {:.1f} mm inside link {} at rest", 1e3 * depth, a.name),
                "the simulation lets these two pass through each other");
      }
  }

  const Robot& robot_;
  const MeshReader& meshes_;
  const RobotKind kind_;
  Tree tree_;
  std::vector<UrdfFinding> findings_;
};

}  // namespace

std::vector<UrdfFinding> check(const Robot& robot, const MeshReader& meshes,
                               const RobotKind& kind) {
  return Checker(robot, meshes, kind).run();
}

bool is_usable(const std::vector<UrdfFinding>& findings) {
  return std::none_of(findings.begin(), findings.end(),
                      [](const UrdfFinding& f) { return f.severity == Severity::error; });
}

}  // namespace prehend::planner
