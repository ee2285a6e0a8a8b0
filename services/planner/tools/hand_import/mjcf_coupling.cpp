#include "services/planner/tools/hand_import/mjcf_coupling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <set>

#include "services/planner/tools/hand_import/mjcf_linkage.hpp"

namespace prehend::planner {
namespace {

using tinyxml2::XMLElement;

// MJCF says no velocities: these, which `prehend hand add` assumes where a URDF does not.
constexpr double hinge_velocity = 2, slide_velocity = 0.1;     // rad/s, m/s
constexpr double smallest_ratio = 1e-4, greatest_ratio = 1e4;  // of two joints that move as one

/// q = multiplier · q of the other + offset.
struct Relation {
  double multiplier = 1, offset = 0;

  Relation inverse() const { return {1 / multiplier, -offset / multiplier}; }
  /// Of this after another: q = this(other(x)).
  Relation after(const Relation& other) const {
    return {multiplier * other.multiplier, multiplier * other.offset + offset};
  }
  bool is_sound() const {
    return std::abs(multiplier) >= smallest_ratio && std::abs(multiplier) <= greatest_ratio &&
           std::abs(offset) <= greatest_ratio;
  }
};

class Coupler {
 public:
  Coupler(MjcfSource& source, const MjcfActuation& actuation, MjcfTree& tree)
      : source_(source), actuation_(actuation), tree_(tree) {}

  void run() {
    for (const XMLElement* each : source_.section("equality")) {
      const char* active = each->Attribute("active");
      if (active && std::string_view(active) == "false") continue;
      const std::string kind = each->Name();
      source_.owner = fmt::format("equality {}", source_.element(*each).text_or("name", kind));
      if (kind == "joint") read_joint(*each);
      if (kind == "tendon")
        source_.complain(Severity::warning, "coupling", *each, "couples tendons, which is not read",
                         "couple their joints: <joint joint1 joint2 polycoef/>");
      if (kind == "connect" || kind == "weld")
        if (auto loop = read_loop(source_, *each, tree_)) loops_.emplace_back(each, *loop);
    }
    for (const auto& tendon : actuation_.tendons) read_tendon(tendon);
    choose_leaders();
    close_loops();
    if (!tree_.joints.empty())
      source_.findings.push_back(
          {Severity::warning, "no-velocity", "robot " + tree_.robot.name, 0,
           "MJCF has no velocity limits",
           fmt::format("{} rad/s and {} m/s assumed", hinge_velocity, slide_velocity)});
    for (const bool follows : {false, true})  // who leads first: others take after it
      for (RobotJoint& each : tree_.robot.joints)
        if (each.mimic.has_value() == follows) finish(each);
  }

 private:
  struct Edge {
    std::string to;
    Relation of_to;  // q of `to` by that of the one that the edge leaves
  };

  /// One that is there.
  RobotJoint& joint(const std::string& name) {
    auto& all = tree_.robot.joints;
    return *std::find_if(all.begin(), all.end(), [&](const auto& j) { return j.name == name; });
  }

  bool are_coupled(const std::string& a, const std::string& b) const {
    std::set<std::string> seen{a};
    std::deque<std::string> open{a};
    for (; !open.empty(); open.pop_front()) {
      if (open.front() == b) return true;
      const auto edges = edges_.find(open.front());
      if (edges == edges_.end()) continue;
      for (const Edge& edge : edges->second)
        if (seen.insert(edge.to).second) open.push_back(edge.to);
    }
    return false;
  }

  /// q of `follower` by that of `leader`.
  void add(const std::string& follower, const std::string& leader, const Relation& relation) {
    if (are_coupled(follower, leader)) return;
    edges_[leader].push_back({follower, relation});
    edges_[follower].push_back({leader, relation.inverse()});
  }

  void read_joint(const XMLElement& at) {
    const MjcfElement element{&at, nullptr};
    const auto one = element.own("joint1"), other = element.own("joint2");
    for (const auto& name : {one, other})
      if (name && !tree_.joints.contains(*name))
        return source_.complain(Severity::error, "mimic-missing", at,
                                fmt::format("couples joint {}, which is not there", *name),
                                "name a joint of this file");
    if (!one)
      return source_.complain(Severity::error, "mimic-missing", at, "names no joint1",
                              "name a joint of this file");
    std::vector<double> c{0, 1, 0, 0, 0};
    if (const auto given = source_.numbers(element, "polycoef", 1, 5))
      std::copy(given->begin(), given->end(), c.begin());
    if (std::any_of(c.begin() + 2, c.end(), [](double x) { return x != 0; }) && other)
      source_.complain(Severity::warning, "coupling", at,
                       fmt::format("joint {} follows {} along a curve", *one, *other),
                       "its first two numbers are taken: a straight line");
    const double ref = tree_.joints.at(*one).ref;
    if (!other || c[1] == 0) return fix(joint(*one), ref + c[0]);
    const Relation relation{c[1], ref + c[0] - c[1] * tree_.joints.at(*other).ref};
    if (*one == *other || !relation.is_sound())
      return source_.complain(
          Severity::error, "coupling", at,
          fmt::format("joint {} follows {} by the factor {}", *one, *other, c[1]),
          "couple two joints by a factor of about 1");
    add(*one, *other, relation);
  }

  static void fix(RobotJoint& joint, double value) {
    joint.X_PJ = joint.X_PJ * motion(joint, value);
    joint.type = "fixed";
  }

  /// Joints that one tendon pulls give way alike: each by its coefficient.
  void read_tendon(const std::vector<std::pair<std::string, double>>& tendon) {
    const auto& [first, unit] = tendon.front();
    for (const auto& [name, coefficient] : tendon) {
      const Relation relation{
          coefficient / unit,
          tree_.joints.at(name).ref - coefficient / unit * tree_.joints.at(first).ref};
      if (name != first && relation.is_sound()) add(name, first, relation);
    }
  }

  /// Lets passive joints of closed loops follow, and says what became of each loop.
  void close_loops() {
    std::vector<MjcfLoop> loops;
    for (const auto& [at, loop] : loops_) loops.push_back(loop);
    std::set<std::string> driven;
    for (const RobotJoint& each : tree_.robot.joints)
      if (drive(each.name) > 0 && !each.mimic) driven.insert(each.name);
    const bool closed = !loops.empty() && close_linkages(loops, driven, tree_);
    for (const auto& [at, loop] : loops_)
      source_.complain(
          Severity::warning, "linkage", "equality " + std::string(at->Name()), *at,
          fmt::format("closes a loop of links at {} and {}, {}", loop.first, loop.second,
                      closed ? "taken as joints that follow the driven one" : "which stays open"),
          "better couple its joints: <equality><joint joint1 joint2 polycoef/>");
  }

  /// With a motor of its own 2, pulled by a tendon 1, else 0.
  int drive(const std::string& name) const {
    if (!actuation_.effort.contains(name)) return 0;
    return actuation_.pulled.contains(name) ? 1 : 2;
  }

  void choose_leaders() {
    std::set<std::string> done;
    for (const int wanted : {2, 1, 0})
      for (const RobotJoint& each : tree_.robot.joints)
        if (each.moves() && !done.contains(each.name) && drive(each.name) == wanted)
          lead(each.name, done);
  }

  /// Makes all that a joint is coupled with follow it.
  void lead(const std::string& leader, std::set<std::string>& done) {
    std::map<std::string, Relation> by_leader{{leader, {}}};
    done.insert(leader);
    std::deque<std::string> open{leader};
    for (; !open.empty(); open.pop_front()) {
      const Relation reached = by_leader.at(open.front());
      for (const Edge& edge : edges_[open.front()]) {
        if (!joint(edge.to).moves() || !done.insert(edge.to).second) continue;
        const Relation relation = edge.of_to.after(reached);
        by_leader[edge.to] = relation;
        open.push_back(edge.to);
        joint(edge.to).mimic = {leader, relation.multiplier, relation.offset};
      }
    }
  }

  void finish(RobotJoint& each) {
    const auto found = tree_.joints.find(each.name);
    if (!each.moves() || found == tree_.joints.end()) return;
    if (each.mimic) follow(each, joint(each.mimic->joint));
    const auto effort = actuation_.effort.find(each.name);
    if (!each.mimic && actuation_.any && !actuation_.unread && effort == actuation_.effort.end())
      source_.complain(
          Severity::warning, "no-actuator", "joint " + each.name, *found->second.at,
          found->second.stiffness > 0 ? "only a spring moves it" : "nothing drives it",
          "taken to have a motor; couple it: <equality><joint joint1 joint2 polycoef/>");
    if (!each.limit && each.type == "continuous") each.limit = JointLimit();
    if (!each.limit) return;
    if (effort != actuation_.effort.end()) each.limit->effort = effort->second;
    each.limit->velocity = each.slides() ? slide_velocity : hinge_velocity;
  }

  /// The range and effort that its leader leaves a follower that has none.
  static void follow(RobotJoint& follower, const RobotJoint& leader) {
    if (!leader.limit) return;
    const double ratio = follower.mimic->multiplier;
    if (!follower.limit && leader.type != "continuous") {
      const double a = ratio * leader.limit->lower + follower.mimic->offset;
      const double b = ratio * leader.limit->upper + follower.mimic->offset;
      follower.limit = JointLimit{std::min(a, b), std::max(a, b), 0, 0};
      if (follower.type == "continuous") follower.type = "revolute";
    }
    if (follower.limit) follower.limit->effort = leader.limit->effort / std::abs(ratio);
  }

  MjcfSource& source_;
  const MjcfActuation& actuation_;
  MjcfTree& tree_;
  std::map<std::string, std::vector<Edge>> edges_;
  std::vector<std::pair<const XMLElement*, MjcfLoop>> loops_;
};

}  // namespace

void couple(MjcfSource& source, const MjcfActuation& actuation, MjcfTree& tree) {
  Coupler(source, actuation, tree).run();
}

}  // namespace prehend::planner
