#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/model/human_hand.hpp"
#include "common/model/shape.hpp"
#include "services/planner/tools/hand_import/finding.hpp"

namespace prehend::planner {

/// A collision or visual element. L: the link's frame, S: the solid's.
struct Solid {
  model::Shape shape;       // unknown: a mesh, or what could not be read
  std::string mesh;         // file name as written; empty: not a mesh
  std::string mesh_folder;  // where the file says that meshes lie; empty: does not say
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  Pose X_LS = Pose::Identity();
  int line = 0;
};

/// Mass in kg; I: frame at the centre of mass, along whose axes the inertia is given, kg m².
struct Inertial {
  double mass = 0;
  Pose X_LI = Pose::Identity();
  Eigen::Matrix3d inertia_I = Eigen::Matrix3d::Zero();
};

struct RobotLink {
  std::string name;
  std::optional<Inertial> inertial;
  std::vector<Solid> collision, visual;
  int line = 0;
};

struct JointLimit {
  double lower = 0, upper = 0;      // rad or m
  double effort = 0, velocity = 0;  // N m or N; rad/s or m/s
  bool has_range = true;            // false: neither lower nor upper was given
};

struct JointMimic {
  std::string joint;
  double multiplier = 1, offset = 0;
};

struct RobotJoint {
  std::string name, type, parent, child;
  Pose X_PJ = Pose::Identity();
  Eigen::Vector3d axis_J = Eigen::Vector3d::UnitX();
  std::optional<JointLimit> limit;
  std::optional<JointMimic> mimic;
  int line = 0;

  bool moves() const { return type != "fixed"; }
  bool slides() const { return type == "prismatic"; }
};

/// All that a URDF says of a robot that matters for a hand, right or wrong. What could not be read
/// is among the findings, so that nothing is dropped without a word.
struct Robot {
  std::string name;
  std::vector<RobotLink> links;
  std::vector<RobotJoint> joints;
  std::vector<UrdfFinding> findings;
  /// Whose tip the finger with this link follows, where a person says so.
  std::map<std::string, model::Finger> human;

  const RobotLink* find_link(const std::string& link) const;
  const RobotJoint* find_joint(const std::string& joint) const;
};

/// What a robot shall be, as far as sizes tell right from wrong.
struct RobotKind {
  double max_link = 0.6;       // m: its links and their shapes are shorter
  double max_mass = 20;        // kg, of a link
  double bone_radius = 0.008;  // m, of the bar that a link without a shape gets
  bool weak = true;            // its motors are as weak as those of fingers
};
inline constexpr RobotKind hand_kind{};
inline constexpr RobotKind arm_kind{2.0, 300, 0.04, false};

/// Reads any bytes; fails only on what is no XML with a <robot> in it.
Expected<Robot> read_robot(const std::string& text);

/// The robot as URDF that model::HandModel reads, without its visuals. Numbers keep all digits.
std::string write_robot(const Robot& robot, const std::string& comment);

}  // namespace prehend::planner
