#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::model {

inline constexpr int min_arm_joints = 6, max_arm_joints = 7;

/// The capsule around a collision shape: a cylinder with round ends, a sphere, or for a box one
/// along its longest edge.
Capsule capsule_around(const CollisionShape& shape);

struct ArmLink {
  std::string name;
  double mass = 0;            // kg
  Eigen::Vector3d com_L;      // centre of mass
  Eigen::Matrix3d inertia_L;  // kg m², about the centre of mass, along the axes of L
  std::vector<CollisionShape> collision;
  std::vector<Capsule> capsules;  // around each of them
};

/// A joint that turns; its frame is that of the link it moves, at q = 0.
struct ArmJoint {
  std::string name;
  Pose X_PJ;                    // in the frame of the link before
  Eigen::Vector3d axis_J;       // unit
  double lower = 0, upper = 0;  // rad
  double velocity = 0;          // rad/s
  double acceleration = 0;      // rad/s²
  double max_torque = 0;        // N m
};

/// A robot arm as data: kinematics, masses and shapes from arm.urdf, the rest from arm.toml.
/// Frames: A, the arm's base (the root link); S, its shoulder; E, its end, of which inverse
/// kinematics speaks; F, the flange on which a hand is screwed, z out of the arm. Values are
/// checked when loaded, so users need not.
struct ArmModel {
  std::string name;
  std::vector<ArmJoint> joints;  // 6 or 7, from base to end
  std::vector<ArmLink> links;    // [0] is the base, [i + 1] is moved by joints[i]
  Pose X_AS = Pose::Identity();
  Pose X_LE = Pose::Identity();  // L: the last link
  Pose X_EF = Pose::Identity();
  Eigen::VectorXd home;  // joints, rad
  int redundant = -1;    // of seven joints the one that is chosen first; -1: of six
  double payload = 0;    // kg, at the flange; 0: nobody says
  /// Links that may come near each other, by index, besides neighbours: their shapes are coarse.
  std::vector<std::pair<int, int>> not_checked;

  /// Loads arm.urdf and arm.toml of a folder. Errors name the file and the element.
  static Expected<ArmModel> load(const std::filesystem::path& directory);
  /// The same from the text of the two files.
  static Expected<ArmModel> parse(std::string_view urdf, std::string_view toml);
};

/// The folder of an arm: what has a slash is a path, anything else a name in models/arms of what
/// came with us or of the user's data folder, or else a folder that lies here.
std::filesystem::path arm_directory(const std::string& arm);

/// The arms that come with us and those of the user, sorted.
std::vector<std::string> arm_names();

/// «choose one of ...», for messages.
std::string arm_hint();

}  // namespace prehend::model
