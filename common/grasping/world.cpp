#include "common/grasping/world.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletCollisionCommon.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "common/analysis/materials.hpp"
#include "common/analysis/wrench_space.hpp"
#include "common/grasping/bullet.hpp"
#include "common/grasping/carrier.hpp"
#include "common/grasping/closest.hpp"
#include "common/grasping/geared_solver.hpp"
#include "common/grasping/hand_body.hpp"
#include "common/grasping/placed_body.hpp"
#include "common/grasping/surface.hpp"

namespace prehend::grasping {
namespace {

constexpr int max_bodies = 1000;
constexpr double beyond = 0.01;  // share of a DoF's range that rounding may leave its limits

Expected<void> check(const model::HandModel& hand, const Pose& X_WB, const Eigen::VectorXd& dof) {
  if (!is_finite(X_WB)) return fail("the hand's pose must be finite", "world");
  if (dof.size() != static_cast<Eigen::Index>(hand.dofs().size()) || !dof.allFinite())
    return fail("the hand needs " + std::to_string(hand.dofs().size()) + " finite DoF values",
                "world");
  for (Eigen::Index i = 0; i < dof.size(); ++i) {
    const model::HandDof& limits = hand.dofs()[static_cast<std::size_t>(i)];
    const double slack = beyond * (limits.upper - limits.lower);
    if (dof[i] < limits.lower - slack || dof[i] > limits.upper + slack)
      return fail("is outside its limits", limits.name,
                  std::to_string(limits.lower) + " to " + std::to_string(limits.upper));
  }
  return {};
}

}  // namespace

using Eigen::Vector3d;
using Eigen::VectorXd;

double torque_scale(const Body& body) {
  return body.mesh ? body.mesh->radius : analysis::torque_scale(body.shape);
}

Eigen::Vector3d centre_of_mass(const Body& body) {
  return body.mesh ? body.mesh->p_OC : model::centre_of_mass(body.shape);
}

std::vector<analysis::Contact> about_centre_of_mass(std::vector<analysis::Contact> contacts,
                                                    const Body& body) {
  for (analysis::Contact& contact : contacts) contact.p_OC -= centre_of_mass(body);
  return contacts;
}

struct World::State {
  const model::HandModel& hand;
  WorldOptions options;

  // Destroyed from the bottom up: users before what they use.
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  GearedSolver solver;
  std::deque<Surface> surfaces;  // of table and bodies; stable addresses
  btMultiBodyDynamicsWorld bullet{&dispatcher, &broadphase, &solver, &configuration};
  btStaticPlaneShape plane{btVector3(0, 0, 1), 0.0};
  std::unique_ptr<btRigidBody> table;
  std::unique_ptr<HandBody> fingers;
  std::vector<PlacedBody> bodies;

  Pose X_WB_command;
  Vector3d velocity_command = Vector3d::Zero();
  VectorXd dof_command;
  VectorXd effort;  // that the DoFs may use; empty: all they have
  Arm arm;
  bool braking = false;

  std::optional<Carrier> carrier;

  State(const model::HandModel& model, const std::vector<analysis::Material>& materials,
        const WorldOptions& world_options)
      : hand(model), options(world_options) {
    bullet.setGravity(btVector3(0, 0, 0));  // of the hand, which its arm carries
    btContactSolverInfo& info = bullet.getSolverInfo();
    info.m_numIterations = options.iterations;
    info.m_erp = 0.2;
    info.m_erp2 = 0.2;
    info.m_globalCfm = 0;
    if (options.table) add_table();
    fingers = std::make_unique<HandBody>(hand, materials, bullet, dt(), options.base);
  }

  ~State() {
    for (PlacedBody& placed : bodies) bullet.removeRigidBody(placed.rigid.get());
    fingers.reset();
    if (table) bullet.removeRigidBody(table.get());
  }

  double dt() const { return 1.0 / options.rate; }

  void add_table() {
    table =
        std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &plane));
    make_touchable(*table, surfaces.emplace_back());
    bullet.addRigidBody(table.get());
  }

  /// Moves the hand there, at rest, and its colliders with it.
  void place(const Pose& X_WB, const VectorXd& dof) {
    fingers->place(X_WB, hand.joint_angles(hand.clamp(dof)),
                   VectorXd::Zero(static_cast<Eigen::Index>(hand.joints().size())));
    arm.stop();
    carrier.reset();
    braking = false;
    X_WB_command = X_WB;
    velocity_command.setZero();
    dof_command = hand.clamp(dof);
  }

  void drive() {
    if (carrier) {
      carrier->step(fingers->X_WC(), fingers->base_velocity(), fingers->base_turning(),
                    options.base, dt());
      fingers->move_base(carrier->velocity(), carrier->turning());
    } else {
      drive_base();
    }
    fingers->drive(dof_command, effort);
  }

  void drive_base() {
    ArmLimits limits = options.arm;
    if (braking) {
      limits.acceleration = options.brake.acceleration;
      limits.turn_acceleration = options.brake.turn_acceleration;
    }
    arm.step(fingers->X_WC(), fingers->X_WC_of(X_WB_command), velocity_command, limits, dt());
    fingers->move_base(arm.velocity(), arm.turning());
  }

  /// Calls visit(point, first, second) for every contact point that carried force in the last step.
  template <class Visit>
  void each_contact(Visit visit) const {
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold =
          *const_cast<btCollisionDispatcher&>(dispatcher).getManifoldByIndexInternal(i);
      const Surface& first = surface_of(manifold.getBody0());
      const Surface& second = surface_of(manifold.getBody1());
      for (int k = 0; k < manifold.getNumContacts(); ++k)
        if (manifold.getContactPoint(k).getAppliedImpulse() > 0)
          visit(manifold.getContactPoint(k), first, second);
    }
  }
};

World::World(std::unique_ptr<State> state) : state_(std::move(state)) {}
World::~World() = default;

Expected<std::unique_ptr<World>> World::create(const model::HandModel& hand, const Pose& X_WB,
                                               const Eigen::VectorXd& dof,
                                               const WorldOptions& options) {
  if (!(options.rate >= 50 && options.rate <= 10000) || options.iterations < 1)
    return fail("steps must be 50 to 10000 Hz, iterations at least 1", "world");
  if (!options.gravity_W.allFinite()) return fail("gravity must be finite", "world");
  if (auto valid = check(hand, X_WB, dof); !valid) return tl::unexpected(valid.error());
  std::vector<analysis::Material> materials;
  for (const model::HandLink& link : hand.links()) {
    const auto material = analysis::material_from_string(link.material);
    if (!material)
      return fail("unknown material " + link.material, link.name,
                  "glass, metal, plastic, wood, rubber or stone");
    materials.push_back(*material);
  }
  auto state = std::make_unique<State>(hand, materials, options);
  state->place(X_WB, dof);
  return std::unique_ptr<World>(new World(std::move(state)));
}

std::unique_ptr<World> World::clone() const {
  // What was valid once is valid again.
  WorldOptions options = state_->options;
  options.base = {};
  std::unique_ptr<World> copy =
      std::move(*create(state_->hand, state_->fingers->X_WB(), state_->dof_command, options));
  State& to = *copy->state_;
  to.fingers->copy_state(*state_->fingers);
  to.arm = state_->arm;
  to.X_WB_command = state_->X_WB_command;
  to.velocity_command = state_->velocity_command;
  to.effort = state_->effort;
  to.braking = state_->braking;
  for (int i = 0; i < body_count(); ++i) {
    copy->add_body(body(i), body_motion(i).X_WO);
    const btRigidBody& original = *state_->bodies[static_cast<std::size_t>(i)].rigid;
    btRigidBody& rigid = *to.bodies.back().rigid;
    rigid.setWorldTransform(original.getWorldTransform());  // the pose above has been rounded
    rigid.setInterpolationWorldTransform(original.getWorldTransform());
    rigid.updateInertiaTensor();
    rigid.setLinearVelocity(original.getLinearVelocity());
    rigid.setAngularVelocity(original.getAngularVelocity());
  }
  return copy;
}

Expected<int> World::add_body(const Body& body, const Pose& X_WO) {
  if (body_count() >= max_bodies)
    return fail("too many bodies", body.name, "at most " + std::to_string(max_bodies));
  if (auto valid = check_body(body, X_WO); !valid) return tl::unexpected(valid.error());
  const auto material = analysis::material_from_string(body.material);
  if (!material) return fail("unknown material " + body.material, body.name);

  PlacedBody placed(body, X_WO);
  const int index = body_count();
  make_touchable(*placed.rigid,
                 state_->surfaces.emplace_back(Surface{*material, body.friction, index, -1}));
  state_->bullet.addRigidBody(placed.rigid.get());
  placed.rigid->setGravity(to_bullet(state_->options.gravity_W));
  state_->bodies.push_back(std::move(placed));
  set_object_damping(state_->options.object_damping);
  return index;
}

void World::move_body(int body, const Pose& X_WO) {
  PlacedBody& placed = state_->bodies[static_cast<std::size_t>(body)];
  placed.move_to(X_WO);
  state_->bullet.updateSingleAabb(placed.rigid.get());
}

void World::set_gravity(const Eigen::Vector3d& gravity_W) {
  state_->options.gravity_W = gravity_W;
  for (PlacedBody& placed : state_->bodies) placed.rigid->setGravity(to_bullet(gravity_W));
}

const Eigen::Vector3d& World::gravity() const {
  return state_->options.gravity_W;
}

void World::set_object_damping(double per_second) {
  state_->options.object_damping = per_second;
  // Bullet takes the share of its velocity that a body loses in a second.
  const double share = 1 - std::exp(-per_second);
  for (PlacedBody& placed : state_->bodies) placed.rigid->setDamping(share, share);
}

Expected<void> World::place_hand(const Pose& X_WB, const Eigen::VectorXd& dof) {
  if (auto valid = check(state_->hand, X_WB, dof); !valid) return valid;
  state_->place(X_WB, dof);
  return {};
}

Expected<void> World::command(const Pose& X_WB, const Eigen::VectorXd& dof,
                              const Vector3d& velocity) {
  if (auto valid = check(state_->hand, X_WB, dof); !valid) return valid;
  if (!velocity.allFinite()) return fail("the hand's velocity must be finite", "world");
  state_->X_WB_command = X_WB;
  state_->velocity_command = velocity;
  state_->dof_command = state_->hand.clamp(dof);
  state_->braking = false;
  return {};
}

Expected<void> World::limit_effort(const VectorXd& effort) {
  if (effort.size() != 0 && effort.size() != state_->dof_command.size())
    return fail("efforts of another hand", "world");
  if (!effort.allFinite() || (effort.array() < 0).any())
    return fail("efforts must be 0 or more", "world");
  state_->effort = effort;
  return {};
}

void World::brake() {
  hold_still();
  state_->braking = true;
}

void World::hold_still() {
  state_->X_WB_command = state_->fingers->X_WB();
  state_->velocity_command.setZero();
  for (Eigen::Index i = 0; i < state_->dof_command.size(); ++i) {
    const model::HandDof& dof = state_->hand.dofs()[static_cast<std::size_t>(i)];
    const double motor = state_->fingers->motor(static_cast<int>(i));
    const double speed = std::abs(state_->fingers->motor_velocity(static_cast<int>(i)));
    const double keep = speed > 0.05 * radian_of(dof) ? 0 : dof.squeeze;
    double& commanded = state_->dof_command[i];
    commanded = std::clamp(commanded, motor - keep, motor + keep);
  }
  state_->dof_command = state_->hand.clamp(state_->dof_command);
}

void World::carry(const Pose& X_WB, const Push& most) {
  if (!state_->carrier) state_->carrier.emplace();
  state_->carrier->aim(state_->fingers->X_WC_of(X_WB), most);
  state_->X_WB_command = X_WB;
}

BaseLoad World::base_load() const {
  if (!state_->carrier) return {};
  return state_->carrier->load(state_->fingers->base_velocity(), state_->fingers->base_turning(),
                               state_->options.base, state_->dt());
}

void World::step() {
  state_->drive();
  state_->bullet.stepSimulation(state_->dt(), 0);
}

double World::time_step() const {
  return state_->dt();
}
const model::HandModel& World::hand() const {
  return state_->hand;
}

HandMotion World::hand_motion() const {
  const auto count = static_cast<Eigen::Index>(state_->hand.joints().size());
  const Eigen::Index dofs = state_->dof_command.size();
  HandMotion motion{state_->fingers->X_WB(), VectorXd(dofs),  VectorXd(dofs),
                    VectorXd(count),         VectorXd(count), VectorXd(count)};
  for (int i = 0; i < count; ++i) {
    motion.joint[i] = state_->fingers->joint(i);
    motion.velocity[i] = state_->fingers->velocity(i);
    motion.torque[i] = state_->fingers->torque(i);
  }
  for (Eigen::Index i = 0; i < dofs; ++i) {
    motion.dof[i] = motion.joint[state_->hand.dofs()[static_cast<std::size_t>(i)].joint];
    motion.motor[i] = state_->fingers->motor(static_cast<int>(i));
  }
  return motion;
}

Pose World::base() const {
  return state_->fingers->X_WB();
}
const Pose& World::commanded_base() const {
  return state_->X_WB_command;
}
const Eigen::VectorXd& World::commanded_dof() const {
  return state_->dof_command;
}
bool World::has_table() const {
  return state_->options.table;
}
int World::body_count() const {
  return static_cast<int>(state_->bodies.size());
}

const Body& World::body(int index) const {
  return state_->bodies[static_cast<std::size_t>(index)].body;
}

BodyMotion World::body_motion(int index) const {
  return state_->bodies[static_cast<std::size_t>(index)].motion();
}

std::vector<analysis::Contact> World::contacts(int body) const {
  std::vector<analysis::Contact> found;
  const Pose X_OW = body_motion(body).X_WO.inverse();
  state_->each_contact([&](const btManifoldPoint& point, const Surface& a, const Surface& b) {
    const bool hand_first = a.link >= 0 && b.body == body;
    if (!hand_first && !(b.link >= 0 && a.body == body)) return;
    const Surface& link = hand_first ? a : b;
    // Bullet's normal points from the second body to the first.
    const Vector3d normal_W = (hand_first ? -1.0 : 1.0) * from_bullet(point.m_normalWorldOnB);
    const Vector3d p_W =
        from_bullet(hand_first ? point.getPositionWorldOnB() : point.getPositionWorldOnA());
    found.push_back({state_->hand.links()[static_cast<std::size_t>(link.link)].name, X_OW * p_W,
                     X_OW.linear() * normal_W, point.m_combinedFriction,
                     point.getAppliedImpulse() / time_step(), std::max(0.0, -point.getDistance()),
                     point.m_combinedSpinningFriction});
  });
  return found;
}

std::vector<Touch> World::touches() const {
  std::vector<Touch> found;
  std::vector<HandBody::LinkMotion> moving;  // only of a hand that is touched
  const auto velocity = [&](const Surface& surface, const Vector3d& p_W) -> Vector3d {
    if (surface.body < 0) return Vector3d::Zero();
    const btRigidBody& rigid = *state_->bodies[static_cast<std::size_t>(surface.body)].rigid;
    return from_bullet(rigid.getVelocityInLocalPoint(to_bullet(p_W) -
                                                     rigid.getCenterOfMassTransform().getOrigin()));
  };
  state_->each_contact([&](const btManifoldPoint& point, const Surface& a, const Surface& b) {
    // Bullet's normal points from the second body to the first, and so do its forces.
    const Vector3d normal_W = from_bullet(point.m_normalWorldOnB);
    const Vector3d force_W =
        from_bullet(point.m_normalWorldOnB * point.getAppliedImpulse() +
                    point.m_lateralFrictionDir1 * point.m_appliedImpulseLateral1 +
                    point.m_lateralFrictionDir2 * point.m_appliedImpulseLateral2) /
        time_step();
    const auto pressed = [&](const Surface& link, const Surface& other, const Vector3d& p_W,
                             double sign) {
      if (link.link < 0 || other.link >= 0) return;
      if (moving.empty()) moving = state_->fingers->link_motions();
      const Vector3d apart =
          velocity(other, p_W) - moving[static_cast<std::size_t>(link.link)].velocity_at(p_W);
      found.push_back({link.link, other.body, p_W, sign * normal_W, sign * force_W,
                       apart - apart.dot(normal_W) * normal_W, point.m_combinedFriction});
    };
    pressed(a, b, from_bullet(point.getPositionWorldOnA()), 1);
    pressed(b, a, from_bullet(point.getPositionWorldOnB()), -1);
  });
  return found;
}

bool World::touches_others(int body) const {
  bool touches = false;
  state_->each_contact([&](const btManifoldPoint&, const Surface& a, const Surface& b) {
    touches |= (a.body == body && b.link < 0) || (b.body == body && a.link < 0);
  });
  return touches;
}

bool World::hand_touches_anything() const {
  bool touches = false;
  state_->each_contact([&](const btManifoldPoint&, const Surface& a, const Surface& b) {
    touches |= (a.link >= 0) != (b.link >= 0);
  });
  return touches;
}

double World::distance_to_hand(int body, double most) const {
  ClosestDistance closest(most);
  auto& bullet = const_cast<btMultiBodyDynamicsWorld&>(state_->bullet);
  for (const auto& collider : state_->fingers->colliders())
    bullet.contactPairTest(collider.get(),
                           state_->bodies[static_cast<std::size_t>(body)].rigid.get(), closest);
  return closest.distance;
}

}  // namespace prehend::grasping
