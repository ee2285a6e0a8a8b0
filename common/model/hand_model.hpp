#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/model/human_hand.hpp"
#include "common/model/placement.hpp"
#include "common/model/shape.hpp"

namespace prehend::model {

/// A collision primitive of a link. L: the link's frame, S: the primitive's.
struct CollisionShape {
  Shape shape;
  Pose X_LS;
};

struct HandLink {
  std::string name;
  int joint = -1;             // the joint that moves it; -1: the base
  int finger = -1;            // the fingertip at the end of its chain; -1: palm, or of several
  double mass = 0;            // kg
  Eigen::Vector3d com_L;      // centre of mass
  Eigen::Matrix3d inertia_L;  // kg m², about the centre of mass, along the axes of L
  std::vector<CollisionShape> collision;
  std::string material;  // of the friction table
};

enum class JointKind { revolute, prismatic };

/// A joint with one axis; its frame is that of the child link at q = 0. q = multiplier * dof +
/// offset. Values are rad and N m of a revolute joint, m and N of a prismatic one.
struct HandJoint {
  std::string name;
  JointKind kind = JointKind::revolute;
  int parent = 0;  // index of the parent link
  int child = 0;
  Pose X_PJ;                    // joint in the parent link's frame at q = 0
  Eigen::Vector3d axis_J;       // unit; what it turns about or slides along
  double lower = 0, upper = 0;  // rad or m
  int dof = 0;
  double multiplier = 1, offset = 0;
  double max_torque = 1;  // N m or N
  /// The clutch of a joint that leads a DoF (Barrett's TorqueSwitch), N m or N: blocked with this
  /// much or more, the motor lets go of the joint, which stays where it is, and drives on the
  /// joints that are coupled to it. The motor takes the joint again when it is driven back.
  std::optional<double> breakaway;
  /// The joint of the same DoF that moves it by gears or bars, whatever pushes; -1: its own drive.
  int geared_to = -1;
};

/// How far past the contact a finger must be commanded to grip with full effort, rad.
inline constexpr double full_squeeze = 0.15;

/// How the joints of a DoF hang together.
enum class Coupling {
  springs,  // each has a drive of its own, so that one that is blocked holds back no other
  fingers,  // gears or bars within each finger, and a drive a finger, as behind a differential
  rigid,    // gears or bars between all
};

/// Values are those of the joint that leads it: rad and rad/s, or m and m/s.
struct HandDof {
  std::string name;
  JointKind kind = JointKind::revolute;
  int joint = 0;  // that leads it: multiplier 1, offset 0
  double lower = 0, upper = 0;
  double max_velocity = 1;
  /// Which way closes the hand: +1, -1, or 0 (spread, abduction).
  int closing = 0;
  /// How far past the contact a command must be to ask for the full effort, rad or m.
  double squeeze = full_squeeze;
  Coupling coupling = Coupling::springs;
};

/// What 1 rad of a finger is for this DoF wherever an angle says how far a hand closes, presses or
/// keeps still: 1 for what turns. A slide has no angle; its squeeze in m asks for the same effort
/// as full_squeeze does of a finger, so m of it per rad are squeeze / full_squeeze.
double radian_of(const HandDof& dof);

struct HandFingertip {
  std::string name;  // finger
  int link = 0;
  Eigen::Vector3d p_LT;  // tip in the link's frame
  /// Whose tip it follows when fingertips are mapped to fingertips; none: of no human finger.
  std::optional<Finger> human;
};

/// What the gate lets through, as far as hand.toml says so: values of all DoFs, in their units.
struct HandGate {
  std::optional<Eigen::VectorXd> lower, upper, velocity, acceleration, effort;
};

/// What the mirror image of a hand of this name is called: NAME_left; of NAME_left NAME_right, and
/// the other way round.
std::string mirror_name(const std::string& name);

/// What has a slash is a path; a name is of ours, of data_directory()/models/hands, or of ./NAME.
/// Also of a mirror image, whose folder is not there: see hand_files().
std::filesystem::path hand_directory(const std::string& hand);

/// Where the files of the hand of this folder are: there, or, for a NAME_left or NAME_right that
/// has none, in the folder beside it of the hand whose mirror image it is. None at all: that
/// folder.
std::filesystem::path hand_files(const std::filesystem::path& folder);
bool is_hand(const std::filesystem::path& folder);  // there are such files

/// The hands that come with us, sorted: the folders in models/hands.
std::vector<std::string> hand_names();

/// The folder of a hand that somebody else names, in a message or a recording: ours or the user's
/// (data_directory()), by its name alone, since a path would open any file.
Expected<std::filesystem::path> named_hand(const std::string& name);
/// Before these, of `told`: hands, by name or path, that this process was told of by its own user.
Expected<std::filesystem::path> named_hand(const std::string& name,
                                           const std::vector<std::string>& told);

/// The hand of the lab that comes with us (lab.toml), for tools that read no configuration.
std::string lab_hand();

/// «choose one of ...», for messages.
std::string hand_hint();

/// A robot hand as data: kinematics and collision shapes from hand.urdf, the rest from hand.toml.
/// B: base frame (the root link). Values are checked when loaded, so users need not.
class HandModel {
 public:
  /// Loads models/hands/<name>/{hand.urdf,hand.toml}, or mirrors the hand of hand_files(). Errors
  /// name the file and the element.
  static Expected<HandModel> load(const std::filesystem::path& directory);
  /// The same from the text of the two files.
  static Expected<HandModel> parse(std::string_view urdf, std::string_view toml);

  /// The mirror image at the plane x = 0 of B, and of the frame of each link, joint and shape: the
  /// pose X of a link there is that of the link here with x turned round on both sides, S X S with
  /// S = diag(-1, 1, 1), at the same joint values. A right hand becomes a left one. The mirror
  /// image of that is the same hand again, to the bit.
  HandModel mirrored() const;

  const std::string& name() const { return name_; }
  const std::vector<HandDof>& dofs() const { return dofs_; }
  const std::vector<HandJoint>& joints() const { return joints_; }  // parents before children
  const std::vector<HandLink>& links() const { return links_; }     // [0] is the base
  const std::vector<HandFingertip>& fingertips() const { return fingertips_; }
  /// Named postures, dof values; always has "open".
  const std::map<std::string, Eigen::VectorXd>& postures() const { return postures_; }
  const Pose& X_BG() const { return X_BG_; }  // grasp frame, see placement.hpp
  const Reach& reach() const { return reach_; }
  const HandGate& gate() const { return gate_; }

  /// Joint angles of given dof values. Sizes: dofs() -> joints().
  Eigen::VectorXd joint_angles(const Eigen::VectorXd& dof) const;
  Eigen::VectorXd clamp(const Eigen::VectorXd& dof) const;
  /// X_BL of every link at the given joint angles.
  std::vector<Pose> link_poses(const Eigen::VectorXd& joint_angles) const;
  /// p_BT of every fingertip at the given dof values.
  std::vector<Eigen::Vector3d> fingertip_positions(const Eigen::VectorXd& dof) const;

 private:
  friend class HandLoader;
  std::string name_, mirror_name_;
  std::vector<HandDof> dofs_;
  std::vector<HandJoint> joints_;
  std::vector<HandLink> links_;
  std::vector<HandFingertip> fingertips_;
  std::map<std::string, Eigen::VectorXd> postures_;
  Pose X_BG_ = Pose::Identity();
  Reach reach_;
  HandGate gate_;
};

}  // namespace prehend::model
