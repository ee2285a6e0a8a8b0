#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "services/planner/tools/hand_import/mjcf_coupling.hpp"

namespace prehend::planner {
namespace {

using tinyxml2::XMLElement;
using Tendon = std::vector<std::pair<std::string, double>>;

double larger_end(const std::vector<double>& range) {
  return std::max(std::abs(range[0]), std::abs(range[1]));
}

class ActuatorReader {
 public:
  ActuatorReader(MjcfSource& source, const MjcfTree& tree) : source_(source), tree_(tree) {}

  MjcfActuation read() {
    read_tendons();
    for (const XMLElement* each : source_.section("actuator")) {
      made_.any = true;
      const MjcfElement actuator = source_.element(*each);
      source_.owner = "actuator " + actuator.text_or("name", each->Name());
      const auto joint =
          actuator.own("joint") ? actuator.own("joint") : actuator.own("jointinparent");
      if (joint)
        drive_joint(actuator, *joint);
      else if (const auto tendon = actuator.own("tendon"))
        drive_tendon(actuator, *tendon);
      else
        leave(actuator, "moves a site or a body");
    }
    return std::move(made_);
  }

 private:
  void read_tendons() {
    for (const XMLElement* each : source_.section("tendon")) {
      const char* name = each->Attribute("name");
      if (!name || std::string_view(each->Name()) != "fixed") continue;
      source_.owner = fmt::format("tendon {}", name);
      Tendon tendon;
      for (const XMLElement* part : source_.children(*each)) {
        const MjcfElement element{part, nullptr};
        const double coefficient = source_.number(element, "coef", 0);
        const auto joint = element.own("joint");
        if (joint && tree_.joints.contains(*joint) && std::abs(coefficient) > 1e-9)
          tendon.emplace_back(*joint, coefficient);
        else if (joint && !tree_.joints.contains(*joint))
          source_.complain(Severity::warning, "mimic-missing", *part,
                           fmt::format("pulls joint {}, which is not there", *joint),
                           "name a joint of this file");
      }
      tendons_[name] = std::move(tendon);
    }
  }

  void leave(const MjcfElement& actuator, const std::string& why) {
    made_.unread = true;
    source_.complain(Severity::warning, "actuator", *actuator.at, why,
                     "give joints or fixed tendons actuators; each joint is taken to have a motor");
  }

  void drive_joint(const MjcfElement& actuator, const std::string& joint) {
    const auto found = tree_.joints.find(joint);
    if (found == tree_.joints.end()) {
      source_.complain(Severity::warning, "mimic-missing", *actuator.at,
                       fmt::format("drives joint {}, which is not there", joint),
                       "name a joint of this file");
      return;
    }
    const RobotJoint* moved = tree_.robot.find_joint(joint);
    const double width = moved && moved->limit ? moved->limit->upper - moved->limit->lower : 0;
    double force = greatest_force(actuator, width);
    if (found->second.effort_bound > 0)
      force = force > 0 ? std::min(force, found->second.effort_bound) : found->second.effort_bound;
    add(joint, force);
  }

  void drive_tendon(const MjcfElement& actuator, const std::string& name) {
    const auto found = tendons_.find(name);
    if (found == tendons_.end() || found->second.empty())
      return leave(actuator, fmt::format("pulls the tendon {}, which is no fixed one", name));
    const double force = greatest_force(actuator, 0);
    for (const auto& [joint, coefficient] : found->second) {
      add(joint, std::abs(coefficient) * force);
      made_.pulled[joint] = name;
    }
    made_.tendons.push_back(found->second);
  }

  void add(const std::string& joint, double force) {
    double& effort = made_.effort[joint];
    effort = std::max(effort, force);
  }

  /// The greatest that an actuator gives, N m or N; 0: it does not say. width: of its joint's
  /// range.
  double greatest_force(const MjcfElement& actuator, double width) {
    const auto gear = source_.numbers(actuator, "gear", 1, 6);
    const double ratio = gear ? std::abs((*gear)[0]) : 1;
    const auto force = source_.numbers(actuator, "forcerange", 2, 2);
    if (force && actuator.text_or("forcelimited", "auto") != "false" && larger_end(*force) > 0)
      return ratio * larger_end(*force);
    const std::string kind = actuator.at->Name();
    const auto control = source_.numbers(actuator, "ctrlrange", 2, 2);
    const auto gains = source_.numbers(actuator, "gainprm", 1, 10);
    const double gain = gains ? (*gains)[0] : 1;
    const bool follows = kind == "position" || kind == "intvelocity" ||
                         (kind == "general" && actuator.text_or("biastype", "none") == "affine");
    if (follows) {
      const double stiffness = source_.number(actuator, "kp", gain);
      return ratio * std::abs(stiffness) * (control ? (*control)[1] - (*control)[0] : width);
    }
    if (!control) return 0;
    if (kind == "motor") return ratio * larger_end(*control);
    if (kind == "general") return ratio * std::abs(gain) * larger_end(*control);
    if (kind == "velocity")
      return ratio * source_.number(actuator, "kv", gain) * larger_end(*control);
    return 0;
  }

  MjcfSource& source_;
  const MjcfTree& tree_;
  std::map<std::string, Tendon> tendons_;
  MjcfActuation made_;
};

}  // namespace

MjcfActuation read_actuators(MjcfSource& source, const MjcfTree& tree) {
  return ActuatorReader(source, tree).read();
}

}  // namespace prehend::planner
