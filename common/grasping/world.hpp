#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/analysis/contact.hpp"
#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/grasping/arm.hpp"
#include "common/grasping/convex_parts.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/shape.hpp"

namespace prehend::grasping {

/// What touches where a shape of Bullet's does not: a mesh, or a cone. O: the middle of the box
/// that bounds it. C: the centre of mass, with the axes of O.
struct SolidMesh {
  ConvexParts parts;          // in O; Bullet adds its margin of 0.5 mm to them
  Eigen::Vector3d p_OC;       // m
  Eigen::Matrix3d inertia_C;  // per kg, m²
  double radius = 0;          // of the vertex that is farthest from C, m
};

/// A rigid body besides the hands.
struct Body {
  std::string name;
  model::Shape shape;
  double mass = 0;                 // kg; 0: does not move
  std::string material = "wood";   // of the friction table
  std::optional<double> friction;  // against everything, instead of the material's
  std::optional<SolidMesh> mesh;   // touches instead of the shape; see mesh_body.hpp
};

/// ρ of its wrenches: the largest distance of a point of the body from its centre of mass, m.
double torque_scale(const Body& body);

/// Of a body of uniform density, in O, m.
Eigen::Vector3d centre_of_mass(const Body& body);

/// Contacts, which say where they are in O, as they are seen from the centre of mass C: what
/// wrenches are about.
std::vector<analysis::Contact> about_centre_of_mass(std::vector<analysis::Contact> contacts,
                                                    const Body& body);

struct WorldOptions {
  double rate = 500;                          // Hz, physics steps
  int iterations = 60;                        // of the contact solver; 100 hold no better
  bool table = true;                          // a fixed plane z = 0, of wood
  Eigen::Vector3d gravity_W = {0, 0, -9.81};  // m/s², of the objects; the hand is compensated
  /// 1/s: damps free objects; for closing without gravity.
  double object_damping = 0;
  ArmLimits arm;      // how fast the hand's base is moved
  BrakeLimits brake;  // how hard it is braked at a stop
  BaseBody base;      // heavy as it is by itself, the base gives way to nothing
  /// How hard each base is pushed on its way, instead of going there whatever it touches: hands
  /// that hold one object do not press each other through it. Wants a base that is not so heavy.
  std::optional<Push> push;
};

/// rad and N m; m and N of what slides.
struct HandMotion {
  Pose X_WB;
  Eigen::VectorXd dof;  // of the joint that leads each DoF
  /// What drives each DoF: the same as dof, except while a clutch has let go of the leading joint
  /// and the motor is further on with the joints coupled to it.
  Eigen::VectorXd motor;
  Eigen::VectorXd joint;
  Eigen::VectorXd velocity;  // of the joints, per s
  Eigen::VectorXd torque;    // that the drives applied in the last step
};

struct BodyMotion {
  Pose X_WO;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          // m/s
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // rad/s, in W
};

/// What pressed on a link of a hand in the last step, at one point.
struct Touch {
  int hand = 0;
  int link = 0;   // of the hand
  int body = -1;  // that presses; -1: the table, or another hand
  Eigen::Vector3d p_W;
  Eigen::Vector3d normal_W;  // unit, into the link
  Eigen::Vector3d force_W;   // N, on the link: pressure and friction
  Eigen::Vector3d slip_W;    // m/s, along the surface, of what presses against the link
  double friction = 0;       // coefficient
};

/// A physical world with hands, a table and objects, stepped by Bullet (double). The base of a hand
/// follows its command within the arm's limits. Each joint is driven by a spring that reaches its
/// torque limit when the command is its DoF's squeeze ahead, no faster than its velocity limit. A
/// clutch lets go of a joint that is blocked (see hand_body.hpp). Deterministic: same calls, same
/// bits. Not thread-safe; worlds are independent of each other. Keeps references to the hands.
/// hand: the number of one; that of create() is 0.
class World {
 public:
  /// Fails on what cannot be simulated: invalid shapes, negative masses, unknown materials.
  static Expected<std::unique_ptr<World>> create(const model::HandModel& hand, const Pose& X_WB,
                                                 const Eigen::VectorXd& dof,
                                                 const WorldOptions& options = {});
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// A new world in the same state, to the bit, and with the same commands; no base is carried as
  /// by carry(): it goes where it is commanded, and without a push gives way to nothing. What
  /// Bullet remembers of the last step's contacts does not go with it, so that the two move apart,
  /// by micrometres where things rest; two clones of the same world stay the same.
  std::unique_ptr<World> clone() const;

  /// Adds a hand and returns its number, 1, 2, ... Fails as create().
  Expected<int> add_hand(const model::HandModel& hand, const Pose& X_WB,
                         const Eigen::VectorXd& dof);
  /// Adds a body and returns its number, 0, 1, ...
  Expected<int> add_body(const Body& body, const Pose& X_WO);
  void move_body(int body, const Pose& X_WO);  // puts it there, at rest
  void set_gravity(const Eigen::Vector3d& gravity_W);
  const Eigen::Vector3d& gravity() const;
  void set_object_damping(double per_second);

  /// Puts the hand there, at rest, without passing through what lies between. Fails as command().
  Expected<void> place_hand(const Pose& X_WB, const Eigen::VectorXd& dof, int hand = 0);
  /// Where base and DoFs shall go from now on. velocity: m/s, in W, of a base that is to be at X_WB
  /// in passing; the next command replaces it. Fails, and leaves the last command in force, on
  /// values that are not finite, of the wrong number, or outside the DoFs' limits by more than
  /// rounding (1 % of the range).
  Expected<void> command(const Pose& X_WB, const Eigen::VectorXd& dof,
                         const Eigen::Vector3d& velocity = Eigen::Vector3d::Zero(), int hand = 0);
  /// What the drives of each DoF may use from now on, N m or N; empty: all they have, as at first.
  /// Fails, and changes nothing, on values that are negative, not finite, or of the wrong number.
  Expected<void> limit_effort(const Eigen::VectorXd& effort, int hand = 0);
  /// Commands base and fingers to stay where they are; a grip keeps its squeeze.
  void hold_still(int hand = 0);
  /// The same, and until the next command the arm brakes as hard as it can.
  void brake(int hand = 0);
  /// From the next step on an arm carries the base and is here, whatever was commanded before. It
  /// pushes no harder than this; base.mass says how heavy it is. place_hand() takes it away again.
  void carry(const Pose& X_WB, const Push& most, int hand = 0);
  /// What pushed against the carried base in the last step; before the first: nothing.
  BaseLoad base_load(int hand = 0) const;

  void step();
  double time_step() const;

  int hand_count() const;
  const model::HandModel& hand(int hand = 0) const;
  HandMotion hand_motion(int hand = 0) const;
  Pose base(int hand = 0) const;
  const Pose& commanded_base(int hand = 0) const;
  const Eigen::VectorXd& commanded_dof(int hand = 0) const;
  bool has_table() const;
  int body_count() const;
  const Body& body(int index) const;
  BodyMotion body_motion(int index) const;

  /// Touches of all hands on a body in the last step.
  std::vector<analysis::Contact> contacts(int body) const;
  /// All that pressed on the hands in the last step, but for their own links.
  std::vector<Touch> touches() const;
  /// True if the body touches anything but hands.
  bool touches_others(int body) const;
  /// But for its own links.
  bool hand_touches_anything(int hand = 0) const;
  /// Distance between hand and body, m, negative when they penetrate; capped at `most`.
  double distance_to_hand(int body, double most = 1.0, int hand = 0) const;

 private:
  struct State;
  explicit World(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace prehend::grasping
