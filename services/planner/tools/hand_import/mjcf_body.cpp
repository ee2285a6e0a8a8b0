#include "services/planner/tools/hand_import/mjcf_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "services/planner/tools/hand_import/mjcf_geom.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;
using tinyxml2::XMLElement;

/// An element of a body, and the frame F that it stands in. B: the body's frame.
struct Item {
  const XMLElement* at;
  Pose X_BF;
  std::string childclass;

  bool is(std::string_view name) const { return at->Name() == name; }
};

class BodyReader {
 public:
  explicit BodyReader(MjcfSource& source) : source_(source), meshes_(read_meshes(source)) {
    for (const XMLElement* each : source.section("contact"))
      for (const char* key : {"geom1", "geom2"})
        if (const char* name = each->Attribute(key)) pairs_.insert(name);
  }

  MjcfTree read() {
    made_.robot.name = source_.model();
    std::vector<Item> world;
    for (const XMLElement* each : source_.section("worldbody"))
      gather(*each, Pose::Identity(), "", world);
    const auto fingers = hands_of(world);
    const bool moves = fingers.size() == 1 && !joints_of(contents(fingers[0])).empty();
    if (fingers.size() == 1 && !moves) {
      read_body(fingers[0], "", Pose::Identity(), true);
    } else if (!fingers.empty()) {
      RobotLink base;
      base.name = unique("world", taken_links_);
      // One body that is led through the world stands above a floor, of several it is the palm.
      if (fingers.size() > 1) read_shapes(world, Pose::Identity(), base);
      made_.robot.links.push_back(base);
      for (const Item& body : fingers) read_body(body, base.name, Pose::Identity(), true);
    }
    return std::move(made_);
  }

 private:
  /// The elements of a body or the world, those of its frames among them.
  void gather(const XMLElement& at, const Pose& X_BF, const std::string& childclass,
              std::vector<Item>& items) {
    if (std::string_view(at.Name()) != "frame") {
      items.push_back({&at, X_BF, childclass});
      return;
    }
    const Pose X_BG = X_BF * source_.pose({&at, nullptr});
    const char* own = at.Attribute("childclass");
    for (const XMLElement* each : source_.children(at))
      gather(*each, X_BG, own ? own : childclass, items);
  }

  std::vector<Item> contents(const Item& body) {
    const char* own = body.at->Attribute("childclass");
    std::vector<Item> items;
    for (const XMLElement* each : source_.children(*body.at))
      gather(*each, Pose::Identity(), own ? own : body.childclass, items);
    return items;
  }

  std::string joint_type(const Item& item) {
    if (item.is("freejoint")) return "free";
    return source_.element(*item.at, item.childclass).text_or("type", "hinge");
  }

  static bool is_joint(const Item& item) { return item.is("joint") || item.is("freejoint"); }

  /// Joints of a body, but for one that lets it float.
  std::vector<Item> joints_of(const std::vector<Item>& items) {
    std::vector<Item> joints;
    for (const Item& item : items)
      if (is_joint(item) && joint_type(item) != "free") joints.push_back(item);
    return joints;
  }

  bool moves(const Item& body) {
    const auto items = contents(body);
    return !joints_of(items).empty() || std::any_of(items.begin(), items.end(), [&](const Item& i) {
      return i.is("body") && moves(i);
    });
  }

  /// Bodies of the world that are hands; what else is there, is told.
  std::vector<Item> hands_of(const std::vector<Item>& world) {
    std::vector<Item> moving, still;
    const std::size_t before = source_.findings.size();
    for (const Item& item : world)
      if (item.is("body")) (moves(item) ? moving : still).push_back(item);
    source_.findings.resize(before);  // they come again when the bodies are read
    if (moving.empty()) return still;
    for (const Item& body : still) {
      const char* name = body.at->Attribute("name");
      source_.complain(Severity::warning, "beside-the-hand",
                       fmt::format("body {}", name ? name : ""), *body.at,
                       "has no joints, so it is no part of the hand", "it is left out");
    }
    return moving;
  }

  static std::string unique(const std::string& wanted, std::set<std::string>& taken) {
    std::string name = wanted;
    for (int k = 2; !taken.insert(name).second; ++k) name = fmt::format("{}_{}", wanted, k);
    return name;
  }

  /// The name that is written, told if there are two; a new one if there is none.
  std::string named(const XMLElement& at, const std::string& otherwise,
                    std::set<std::string>& taken) {
    const char* name = at.Attribute("name");
    if (!name || !*name) return unique(otherwise, taken);
    source_.owner =
        fmt::format("{} {}", std::string_view(at.Name()) == "body" ? "link" : "joint", name);
    if (!taken.insert(name).second)
      source_.complain(Severity::error, "duplicate-name", at, "there are two of this name",
                       "rename one of them");
    return name;
  }

  /// X_PB: pose of the body that this one stands in, in the frame of that one's link. outermost: it
  /// stands in the world.
  void read_body(const Item& body, const std::string& parent, const Pose& X_PB, bool outermost) {
    RobotLink link;
    link.name = named(*body.at, "body", taken_links_);
    link.line = body.at->GetLineNum();
    source_.owner = "link " + link.name;
    const Pose X_PN = X_PB * body.X_BF * source_.pose({body.at, nullptr});
    const auto items = contents(body);
    const Pose X_LN = parent.empty() ? Pose::Identity()
                                     : hang(joints_of(items), *body.at, parent, link.name, X_PN);
    source_.owner = "link " + link.name;
    read_shapes(items, X_LN, link);
    made_.robot.links.push_back(link);
    made_.bodies[link.name] = X_LN;
    for (const Item& item : items) {
      if (item.is("body")) read_body(item, link.name, X_LN, false);
      if (!outermost && is_joint(item) && joint_type(item) == "free")
        source_.complain(Severity::error, "joint-type", "link " + link.name, *item.at,
                         "floats inside the hand", "use hinges and slides");
      for (const char* unread : {"composite", "flexcomp", "replicate", "attach", "plugin"})
        if (item.is(unread))
          source_.complain(Severity::error, "not-read", "link " + link.name, *item.at,
                           fmt::format("<{}> makes parts that are not read", unread),
                           "save the model as MuJoCo compiled it (mj_saveLastXML)");
    }
  }

  /// Hangs a body on a link by its joints; X_PN: where it stands there. Gives its pose in the frame
  /// of the last joint.
  Pose hang(const std::vector<Item>& joints, const XMLElement& body, std::string parent,
            const std::string& link, const Pose& X_PN) {
    if (joints.empty()) {
      RobotJoint joint;
      joint.name = unique(link + "_fixed", taken_joints_);
      joint.type = "fixed";
      joint.parent = parent;
      joint.child = link;
      joint.X_PJ = X_PN;
      joint.line = body.GetLineNum();
      made_.robot.joints.push_back(std::move(joint));
      return Pose::Identity();
    }
    Pose X_LN = X_PN;  // the body in the link that the next joint hangs on
    for (std::size_t i = 0; i < joints.size(); ++i) {
      RobotJoint joint = read_joint(joints[i], link);
      joint.parent = parent;
      const MjcfElement element = source_.element(*joints[i].at, joints[i].childclass);
      const Vector3d p_NJ = joints[i].X_BF * source_.vector(element, "pos", Vector3d::Zero());
      joint.X_PJ = X_LN * make_pose(p_NJ) * motion(joint, -made_.joints[joint.name].ref);
      X_LN = make_pose(Vector3d(-p_NJ));
      joint.child = i + 1 < joints.size() ? unique(link + "_" + joint.name, taken_links_) : link;
      if (joint.child != link) made_.robot.links.push_back({joint.child, {}, {}, {}, joint.line});
      parent = joint.child;
      made_.robot.joints.push_back(std::move(joint));
    }
    return X_LN;
  }

  RobotJoint read_joint(const Item& item, const std::string& link) {
    const MjcfElement element = source_.element(*item.at, item.childclass);
    RobotJoint joint;
    joint.name = named(*item.at, link + "_joint", taken_joints_);
    source_.owner = "joint " + joint.name;
    joint.line = item.at->GetLineNum();
    const std::string type = joint_type(item);
    const bool turns = type == "hinge";
    const double unit = turns ? source_.compiler().angle : 1;
    joint.axis_J = item.X_BF.linear() * source_.vector(element, "axis", Vector3d::UnitZ());
    if (joint.axis_J.norm() > 1e-6) joint.axis_J.normalize();
    joint.type = turns ? "revolute" : type == "slide" ? "prismatic" : type;

    MjcfJoint more;
    more.at = item.at;
    more.ref = unit * source_.number(element, "ref", 0);
    more.stiffness = source_.number(element, "stiffness", 0);
    more.springref = unit * source_.number(element, "springref", 0);
    if (const auto force = source_.numbers(element, "actuatorfrcrange", 2, 2))
      more.effort_bound = std::max(std::abs((*force)[0]), std::abs((*force)[1]));
    made_.joints[joint.name] = more;

    const auto range = source_.numbers(element, "range", 2, 2);
    const std::string limited = element.text_or("limited", "auto");
    if (range && (limited == "true" || (limited != "false" && source_.compiler().autolimits))) {
      joint.limit = JointLimit{unit * (*range)[0], unit * (*range)[1], 0, 0};
    } else if (turns) {
      joint.type = "continuous";
    }
    return joint;
  }

  /// Geoms and <inertial> of a body that stands at X_LN in its link.
  void read_shapes(const std::vector<Item>& items, const Pose& X_LN, RobotLink& link) {
    std::vector<MjcfGeom> geoms;
    for (const Item& item : items) {
      if (item.is("inertial") && !source_.compiler().inertia_from_geoms)
        read_inertial(*item.at, X_LN, link);
      if (const char* name = item.is("site") ? item.at->Attribute("name") : nullptr)
        made_.sites[name] = {
            link.name, X_LN * item.X_BF * source_.pose(source_.element(*item.at, item.childclass))};
      if (!item.is("geom")) continue;
      const MjcfElement element = source_.element(*item.at, item.childclass);
      if (link.name == "world" && element.text_or("type", "sphere") == "plane") continue;
      if (auto geom = read_geom(source_, element, item.X_BF, meshes_, pairs_)) {
        for (Solid& solid : geom->solids) solid.X_LS = X_LN * solid.X_LS;
        geom->inertial_B.X_LI = X_LN * geom->inertial_B.X_LI;
        geoms.push_back(std::move(*geom));
      }
    }
    add_geoms(geoms, link);
    if (!link.inertial) link.inertial = given_mass(geoms);
  }

  void read_inertial(const XMLElement& at, const Pose& X_LN, RobotLink& link) {
    const MjcfElement element{&at, nullptr};
    Inertial inertial;
    inertial.mass = source_.number(element, "mass", 0);
    inertial.X_LI = X_LN * source_.pose(element);
    if (const auto full = source_.numbers(element, "fullinertia", 6, 6)) {
      const auto& i = *full;
      inertial.inertia_I << i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2];
    } else {
      inertial.inertia_I = source_.vector(element, "diaginertia", Vector3d::Zero()).asDiagonal();
    }
    link.inertial = inertial;
  }

  MjcfSource& source_;
  const MjcfMeshes meshes_;
  std::set<std::string> pairs_, taken_links_, taken_joints_;
  MjcfTree made_;
};

}  // namespace

MjcfTree read_bodies(MjcfSource& source) {
  return BodyReader(source).read();
}

Pose motion(const RobotJoint& joint, double value) {
  if (joint.axis_J.norm() < 1e-6) return Pose::Identity();
  if (joint.slides()) return make_pose(value * joint.axis_J);
  return make_pose(Vector3d::Zero(), Eigen::Quaterniond(Eigen::AngleAxisd(value, joint.axis_J)));
}

}  // namespace prehend::planner
