#include "services/planner/tools/hand_import/robot.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>

#include "common/base/finite_number.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;
using tinyxml2::XMLElement;

/// Reads the elements of a document into a robot; what is wrong becomes a finding.
class Reader {
 public:
  void read(const XMLElement& root) {
    robot.name = text(root, "name");
    // MuJoCo's dialect of URDF.
    if (const XMLElement* mujoco = root.FirstChildElement("mujoco"))
      if (const XMLElement* compiler = mujoco->FirstChildElement("compiler"))
        mesh_folder_ = text(*compiler, "meshdir");
    for (const XMLElement* e = root.FirstChildElement(); e; e = e->NextSiblingElement()) {
      const std::string kind = e->Name();
      if (kind == "link") read_link(*e);
      if (kind == "joint") read_joint(*e);
    }
  }

  Robot robot;

 private:
  void complain(Severity severity, const char* code, const XMLElement& at, std::string what,
                std::string repair) {
    robot.findings.push_back(
        {severity, code, owner_, at.GetLineNum(), std::move(what), std::move(repair)});
  }

  static std::string text(const XMLElement& e, const char* key) {
    const char* value = e.Attribute(key);
    return value ? value : "";
  }

  /// The numbers of an attribute, exactly `count` and finite; `otherwise` where it is absent.
  std::vector<double> numbers(const XMLElement& e, const char* key, std::size_t count,
                              const std::vector<double>& otherwise) {
    const char* value = e.Attribute(key);
    if (!value) return otherwise;
    const auto found = finite_numbers(value);
    if (found && found->size() == count) return *found;
    complain(Severity::error, "bad-number", e,
             fmt::format("<{}> has {}=\"{}\"", e.Name(), key, value),
             fmt::format("{} finite number{}", count, count > 1 ? "s" : ""));
    return otherwise;
  }

  double number(const XMLElement& e, const char* key, double otherwise) {
    return numbers(e, key, 1, {otherwise})[0];
  }

  Pose origin(const XMLElement& owner) {
    const XMLElement* e = owner.FirstChildElement("origin");
    if (!e) return Pose::Identity();
    const auto xyz = numbers(*e, "xyz", 3, {0, 0, 0}), rpy = numbers(*e, "rpy", 3, {0, 0, 0});
    return make_pose(Vector3d(xyz.data()),
                     Eigen::Quaterniond(Eigen::AngleAxisd(rpy[2], Vector3d::UnitZ()) *
                                        Eigen::AngleAxisd(rpy[1], Vector3d::UnitY()) *
                                        Eigen::AngleAxisd(rpy[0], Vector3d::UnitX())));
  }

  /// The name of an element, which must be there and be its own.
  template <class Items>
  std::string name_of(const XMLElement& e, const Items& others) {
    const std::string name = text(e, "name");
    owner_ = fmt::format("{} {}", e.Name(), name);
    if (name.empty()) {
      complain(Severity::error, "no-name", e, fmt::format("a <{}> has no name", e.Name()),
               "give it one");
    } else if (std::any_of(others.begin(), others.end(),
                           [&](const auto& other) { return other.name == name; })) {
      complain(Severity::error, "duplicate-name", e, "there are two of this name",
               "rename one of them");
    }
    return name;
  }

  void read_link(const XMLElement& e) {
    RobotLink link;
    link.name = name_of(e, robot.links);
    link.line = e.GetLineNum();
    if (const XMLElement* inertial = e.FirstChildElement("inertial"))
      read_inertial(*inertial, link);
    for (const XMLElement* s = e.FirstChildElement(); s; s = s->NextSiblingElement()) {
      if (std::string(s->Name()) == "collision") link.collision.push_back(read_solid(*s, true));
      if (std::string(s->Name()) == "visual") link.visual.push_back(read_solid(*s, false));
    }
    robot.links.push_back(std::move(link));
  }

  void read_inertial(const XMLElement& e, RobotLink& link) {
    Inertial inertial;
    inertial.X_LI = origin(e);
    const XMLElement* mass = e.FirstChildElement("mass");
    inertial.mass = mass ? number(*mass, "value", 0) : 0;
    if (const XMLElement* i = e.FirstChildElement("inertia")) {
      const double xy = number(*i, "ixy", 0), xz = number(*i, "ixz", 0), yz = number(*i, "iyz", 0);
      inertial.inertia_I << number(*i, "ixx", 0), xy, xz, xy, number(*i, "iyy", 0), yz, xz, yz,
          number(*i, "izz", 0);
    }
    link.inertial = inertial;
  }

  Solid read_solid(const XMLElement& e, bool collision) {
    Solid solid;
    solid.line = e.GetLineNum();
    solid.X_LS = origin(e);
    const Severity severity = collision ? Severity::error : Severity::warning;
    const XMLElement* geometry = e.FirstChildElement("geometry");
    const XMLElement* g = geometry ? geometry->FirstChildElement() : nullptr;
    if (!g) {
      complain(severity, "no-geometry", e, fmt::format("a <{}> has no geometry", e.Name()),
               "box, cylinder, sphere or mesh");
      return solid;
    }
    const std::string kind = g->Name();
    if (kind == "box") {
      solid.shape = {model::ShapeKind::box, Vector3d(numbers(*g, "size", 3, {0, 0, 0}).data())};
    } else if (kind == "cylinder") {
      const double radius = number(*g, "radius", 0);
      solid.shape = {model::ShapeKind::cylinder, {radius, radius, number(*g, "length", 0)}};
    } else if (kind == "sphere") {
      solid.shape = {model::ShapeKind::sphere, Vector3d::Constant(number(*g, "radius", 0))};
    } else if (kind == "mesh") {
      solid.mesh = text(*g, "filename");
      solid.mesh_folder = mesh_folder_;
      solid.scale = Vector3d(numbers(*g, "scale", 3, {1, 1, 1}).data());
      if (solid.mesh.empty())
        complain(severity, "no-geometry", *g, "a mesh has no filename", "name its file");
      return solid;
    } else {
      complain(severity, "unknown-geometry", *g,
               fmt::format("<{}> is no geometry of URDF and would be dropped", kind),
               "use boxes, cylinders, spheres or a mesh");
      return solid;
    }
    if (!is_valid(solid.shape)) {
      complain(severity, "bad-size", *g, fmt::format("a {} without a positive size", kind),
               "sizes are positive, in metres");
      solid.shape = {};
    }
    return solid;
  }

  void read_joint(const XMLElement& e) {
    RobotJoint joint;
    joint.name = name_of(e, robot.joints);
    joint.line = e.GetLineNum();
    joint.type = text(e, "type");
    joint.X_PJ = origin(e);
    for (const auto& [key, name] : {std::pair("parent", &joint.parent), {"child", &joint.child}}) {
      const XMLElement* end = e.FirstChildElement(key);
      *name = end ? text(*end, "link") : "";
      if (name->empty())
        complain(Severity::error, "missing-link", e, fmt::format("has no <{} link=…>", key),
                 "name a link");
    }
    if (const XMLElement* axis = e.FirstChildElement("axis"))
      joint.axis_J = Vector3d(numbers(*axis, "xyz", 3, {1, 0, 0}).data());
    if (const XMLElement* limit = e.FirstChildElement("limit"))
      joint.limit = {number(*limit, "lower", 0), number(*limit, "upper", 0),
                     number(*limit, "effort", 0), number(*limit, "velocity", 0),
                     limit->Attribute("lower") || limit->Attribute("upper")};
    if (const XMLElement* mimic = e.FirstChildElement("mimic"))
      joint.mimic = {text(*mimic, "joint"), number(*mimic, "multiplier", 1),
                     number(*mimic, "offset", 0)};
    robot.joints.push_back(std::move(joint));
  }

  std::string owner_;        // element that is being read
  std::string mesh_folder_;  // of the whole robot
};

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  return safe;
}

std::string origin_of(const Pose& X) {
  const Vector3d p = X.translation();
  const Vector3d ypr = X.linear().eulerAngles(2, 1, 0);
  return fmt::format("<origin xyz=\"{} {} {}\" rpy=\"{} {} {}\"/>", p.x(), p.y(), p.z(), ypr[2],
                     ypr[1], ypr[0]);
}

std::string geometry_of(const model::Shape& shape) {
  const Vector3d& s = shape.size;
  if (shape.kind == model::ShapeKind::box)
    return fmt::format("<box size=\"{} {} {}\"/>", s.x(), s.y(), s.z());
  if (shape.kind == model::ShapeKind::cylinder)
    return fmt::format("<cylinder radius=\"{}\" length=\"{}\"/>", s.x(), s.z());
  return fmt::format("<sphere radius=\"{}\"/>", s.x());
}

}  // namespace

const RobotLink* Robot::find_link(const std::string& link) const {
  const auto found =
      std::find_if(links.begin(), links.end(), [&](const auto& l) { return l.name == link; });
  return found == links.end() ? nullptr : &*found;
}

const RobotJoint* Robot::find_joint(const std::string& joint) const {
  const auto found =
      std::find_if(joints.begin(), joints.end(), [&](const auto& j) { return j.name == joint; });
  return found == joints.end() ? nullptr : &*found;
}

Expected<Robot> read_robot(const std::string& text) {
  if (text.find('\0') != std::string::npos) return fail("holds a zero byte", {}, "XML is text");
  tinyxml2::XMLDocument document;
  document.Parse(text.data(), text.size());
  if (document.Error())
    return fail("is not XML", fmt::format("line {}", document.ErrorLineNum()),
                tinyxml2::XMLDocument::ErrorIDToName(document.ErrorID()));
  const XMLElement* root = document.FirstChildElement("robot");
  if (!root)
    return fail("has no <robot>", {}, "a URDF; xacro files must be expanded by `xacro` first");
  for (const XMLElement* each = root->FirstChildElement(); each; each = each->NextSiblingElement())
    if (std::string_view(each->Name()).starts_with("xacro:"))
      return fail("is xacro", fmt::format("line {}", each->GetLineNum()),
                  "`xacro FILE > FILE.urdf` makes a URDF of it");
  Reader reader;
  reader.read(*root);
  return std::move(reader.robot);
}

std::string write_robot(const Robot& robot, const std::string& comment) {
  std::string out = fmt::format("<?xml version=\"1.0\"?>\n<!-- {} -->\n<robot name=\"{}\">\n",
                                comment, escaped(robot.name));
  for (const RobotLink& link : robot.links) {
    out += fmt::format("  <link name=\"{}\">\n", escaped(link.name));
    if (link.inertial) {
      const Eigen::Matrix3d& i = link.inertial->inertia_I;
      out += fmt::format(
          "    <inertial>\n      {}\n      <mass value=\"{}\"/>\n      <inertia ixx=\"{}\" "
          "ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/>\n    </inertial>\n",
          origin_of(link.inertial->X_LI), link.inertial->mass, i(0, 0), i(0, 1), i(0, 2), i(1, 1),
          i(1, 2), i(2, 2));
    }
    for (const Solid& solid : link.collision)
      out += fmt::format(
          "    <collision>\n      {}\n      <geometry>{}</geometry>\n    </collision>\n",
          origin_of(solid.X_LS), geometry_of(solid.shape));
    out += "  </link>\n";
  }
  for (const RobotJoint& joint : robot.joints) {
    out += fmt::format(
        "  <joint name=\"{}\" type=\"{}\">\n    <parent link=\"{}\"/>\n    <child link=\"{}\"/>\n"
        "    {}\n    <axis xyz=\"{} {} {}\"/>\n",
        escaped(joint.name), joint.type, escaped(joint.parent), escaped(joint.child),
        origin_of(joint.X_PJ), joint.axis_J.x(), joint.axis_J.y(), joint.axis_J.z());
    if (joint.limit)
      out += fmt::format("    <limit lower=\"{}\" upper=\"{}\" effort=\"{}\" velocity=\"{}\"/>\n",
                         joint.limit->lower, joint.limit->upper, joint.limit->effort,
                         joint.limit->velocity);
    if (joint.mimic)
      out += fmt::format("    <mimic joint=\"{}\" multiplier=\"{}\" offset=\"{}\"/>\n",
                         escaped(joint.mimic->joint), joint.mimic->multiplier, joint.mimic->offset);
    out += "  </joint>\n";
  }
  return out + "</robot>\n";
}

}  // namespace prehend::planner
