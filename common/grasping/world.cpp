#include "world.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <btBulletCollisionCommon.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <prehend/analysis/materials.hpp>
#include <utility>

namespace prehend::grasping {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double collision_margin = 0.0005;  // m; Bullet's default of 0.04 is far too much here
// The hand's base follows its command and is not moved by what the hand touches: it weighs so much
// that the reaction of fingers and objects is lost in its inertia.
constexpr double base_mass = 1000;    // kg
constexpr double base_inertia = 100;  // kg m²
constexpr double base_gain = 25;      // 1/s, of the arm's position loop
constexpr double drive_gain = 0.1;    // share of a joint's error that the drive removes each step
constexpr double least_drive = 0.1;   // share of its torque that a drive may always use
constexpr double spinning_friction = 0.002;  // of soft pads, m
constexpr double rolling_friction = 0.0002;  // m; keeps a standing or lying cylinder where it is

btVector3 to_bullet(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
Vector3d from_bullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

btQuaternion to_bullet(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  return {q.x(), q.y(), q.z(), q.w()};
}

btTransform to_bullet(const Pose& X) {
  return btTransform(to_bullet(Eigen::Matrix3d(X.linear())), to_bullet(Vector3d(X.translation())));
}

Pose from_bullet(const btTransform& X) {
  const btQuaternion q = X.getRotation();
  return make_pose(from_bullet(X.getOrigin()),
                   Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).normalized());
}

/// What a collider is made of and whose it is.
struct Surface {
  analysis::Material material = analysis::Material::wood;
  std::optional<double> friction;
  int body = -1;  // number of the body; -1: table
  int link = -1;  // of the hand; -1: not the hand
};

double friction_between(const Surface& a, const Surface& b) {
  if (a.friction || b.friction)
    return std::min(a.friction.value_or(std::numeric_limits<double>::infinity()),
                    b.friction.value_or(std::numeric_limits<double>::infinity()));
  return analysis::friction(a.material, b.material);
}

const Surface& surface_of(const btCollisionObject* object) {
  return *static_cast<const Surface*>(object->getUserPointer());
}

/// Bullet multiplies two numbers for friction; the table knows pairs.
bool set_friction(btManifoldPoint& point, const btCollisionObjectWrapper* a, int, int,
                  const btCollisionObjectWrapper* b, int, int) {
  const Surface& first = surface_of(a->getCollisionObject());
  const Surface& second = surface_of(b->getCollisionObject());
  point.m_combinedFriction = friction_between(first, second);
  const bool slippery = point.m_combinedFriction < 0.1;
  point.m_combinedSpinningFriction = slippery ? 0 : spinning_friction;
  point.m_combinedRollingFriction = slippery ? 0 : rolling_friction;
  return true;
}

std::unique_ptr<btCollisionShape> make_shape(const model::Shape& shape) {
  std::unique_ptr<btCollisionShape> made;
  switch (shape.kind) {
    case model::ShapeKind::box:
      made = std::make_unique<btBoxShape>(to_bullet(Vector3d(0.5 * shape.size)));
      break;
    case model::ShapeKind::cylinder:
      made = std::make_unique<btCylinderShapeZ>(
          btVector3(shape.size.x(), shape.size.x(), 0.5 * shape.size.z()));
      break;
    default:
      return std::make_unique<btSphereShape>(shape.size.x());
  }
  made->setMargin(collision_margin);
  return made;
}

/// Link pairs that overlap when the hand rests, as neighbours do, never collide.
struct SelfCollisionFilter : btOverlapFilterCallback {
  std::vector<std::pair<int, int>> ignored;

  bool needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const override {
    const auto* first = static_cast<const btCollisionObject*>(a->m_clientObject);
    const auto* second = static_cast<const btCollisionObject*>(b->m_clientObject);
    const int i = surface_of(first).link, j = surface_of(second).link;
    if (i < 0 && j < 0) return !(first->isStaticObject() && second->isStaticObject());
    if (i < 0 || j < 0) return true;
    return std::find(ignored.begin(), ignored.end(), std::pair(std::min(i, j), std::max(i, j))) ==
           ignored.end();
  }
};

/// Smallest distance that a test between two colliders finds.
struct ClosestDistance : btCollisionWorld::ContactResultCallback {
  double distance;

  explicit ClosestDistance(double most) : distance(most) { m_closestDistanceThreshold = most; }
  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    distance = std::min(distance, point.getDistance());
    return 0;
  }
};

/// Speed that reaches `distance` soonest without overshoot, within the limits.
double approach_speed(double distance, double speed, double acceleration) {
  return std::min({base_gain * distance, std::sqrt(2 * acceleration * distance), speed});
}

/// The velocity of the next step towards `error`, from `velocity`.
Vector3d follow(const Vector3d& error, const Vector3d& velocity, double speed, double acceleration,
                double dt) {
  const double distance = error.norm();
  Vector3d wanted = Vector3d::Zero();
  if (distance > 1e-12) wanted = approach_speed(distance, speed, acceleration) / distance * error;
  const Vector3d change = wanted - velocity;
  const double most = acceleration * dt;
  return change.norm() <= most ? wanted : Vector3d(velocity + most * change.normalized());
}

}  // namespace

struct World::State {
  struct Placed {
    Body body;
    std::unique_ptr<btCollisionShape> shape;
    std::unique_ptr<btRigidBody> rigid;
  };

  const model::HandModel& hand;
  WorldOptions options;

  // Destroyed from the bottom up: users before what they use.
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btMultiBodyConstraintSolver solver;
  SelfCollisionFilter filter;
  std::deque<Surface> surfaces;  // stable addresses
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  btMultiBodyDynamicsWorld bullet{&dispatcher, &broadphase, &solver, &configuration};
  std::unique_ptr<btRigidBody> table;
  std::unique_ptr<btMultiBody> multibody;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders;  // of each link
  std::vector<std::unique_ptr<btMultiBodyJointMotor>> motors;       // of each joint
  std::vector<std::unique_ptr<btMultiBodyJointLimitConstraint>> limits;
  std::vector<int> leaders;  // joint of each DoF
  std::vector<Placed> bodies;

  Pose X_WB_command;
  VectorXd dof_command;
  Vector3d base_velocity = Vector3d::Zero();
  Vector3d base_turn = Vector3d::Zero();

  State(const model::HandModel& model, const WorldOptions& world_options)
      : hand(model), options(world_options) {
    // The same function for every world, so it does not matter who sets it last.
    gContactAddedCallback = set_friction;
    broadphase.getOverlappingPairCache()->setOverlapFilterCallback(&filter);
    bullet.setGravity(btVector3(0, 0, 0));  // of the hand, which its arm carries
    btContactSolverInfo& info = bullet.getSolverInfo();
    info.m_numIterations = options.iterations;
    info.m_erp = 0.2;
    info.m_erp2 = 0.2;
    info.m_globalCfm = 0;
  }

  ~State() {
    for (Placed& placed : bodies) bullet.removeRigidBody(placed.rigid.get());
    for (auto& motor : motors) bullet.removeMultiBodyConstraint(motor.get());
    for (auto& limit : limits) bullet.removeMultiBodyConstraint(limit.get());
    for (auto& collider : colliders) bullet.removeCollisionObject(collider.get());
    if (multibody) bullet.removeMultiBody(multibody.get());
    if (table) bullet.removeRigidBody(table.get());
  }

  double dt() const { return 1.0 / options.rate; }

  Surface* add_surface(analysis::Material material, std::optional<double> own_friction, int body,
                       int link) {
    return &surfaces.emplace_back(Surface{material, own_friction, body, link});
  }

  void make_touchable(btCollisionObject& object, Surface* surface) {
    object.setUserPointer(surface);
    object.setCollisionFlags(object.getCollisionFlags() |
                             btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK);
    // Bullet skips rolling and spinning friction unless the objects ask for some.
    object.setSpinningFriction(spinning_friction);
    object.setRollingFriction(rolling_friction);
    object.setFriction(1.0);
    object.setRestitution(0);
    object.setActivationState(DISABLE_DEACTIVATION);
  }

  void add_table() {
    shapes.push_back(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), 0.0));
    btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, shapes.back().get());
    table = std::make_unique<btRigidBody>(info);
    make_touchable(*table, add_surface(analysis::Material::wood, std::nullopt, -1, -1));
    bullet.addRigidBody(table.get());
  }

  void add_hand(const std::vector<analysis::Material>& materials) {
    const auto& links = hand.links();
    const auto& joints = hand.joints();
    const int count = static_cast<int>(joints.size());
    multibody = std::make_unique<btMultiBody>(
        count, base_mass, btVector3(base_inertia, base_inertia, base_inertia), false, false);
    for (int i = 0; i < count; ++i) {
      const model::HandJoint& joint = joints[static_cast<std::size_t>(i)];
      const model::HandLink& link = links[static_cast<std::size_t>(joint.child)];
      const model::HandLink& parent = links[static_cast<std::size_t>(joint.parent)];
      multibody->setupRevolute(
          i, link.mass, to_bullet(Vector3d(link.inertia_L.diagonal())), parent.joint,
          to_bullet(Eigen::Matrix3d(joint.X_PJ.linear())).inverse(), to_bullet(joint.axis_J),
          to_bullet(Vector3d(joint.X_PJ.translation() - parent.com_L)), to_bullet(link.com_L),
          true);
    }
    multibody->finalizeMultiDof();
    multibody->setHasSelfCollision(true);
    multibody->setCanSleep(false);
    multibody->setLinearDamping(0);
    multibody->setAngularDamping(0);
    multibody->setUseGyroTerm(false);
    bullet.addMultiBody(multibody.get());

    for (int i = 0; i < static_cast<int>(links.size()); ++i) {
      const model::HandLink& link = links[static_cast<std::size_t>(i)];
      auto compound = std::make_unique<btCompoundShape>();
      for (const model::CollisionShape& part : link.collision) {
        shapes.push_back(make_shape(part.shape));
        Pose X_CS = part.X_LS;
        X_CS.translation() -= link.com_L;
        compound->addChildShape(to_bullet(X_CS), shapes.back().get());
      }
      auto collider = std::make_unique<btMultiBodyLinkCollider>(multibody.get(), link.joint);
      collider->setCollisionShape(compound.get());
      shapes.push_back(std::move(compound));
      make_touchable(*collider,
                     add_surface(materials[static_cast<std::size_t>(i)], std::nullopt, -1, i));
      if (link.joint < 0)
        multibody->setBaseCollider(collider.get());
      else
        multibody->getLink(link.joint).m_collider = collider.get();
      colliders.push_back(std::move(collider));
    }
    ignore_overlaps();
    for (auto& collider : colliders)
      bullet.addCollisionObject(collider.get(), btBroadphaseProxy::DefaultFilter,
                                btBroadphaseProxy::AllFilter);
    add_drives();
  }

  void ignore_overlaps() {
    place(Pose::Identity(), hand.postures().at("open"));
    for (std::size_t i = 0; i < colliders.size(); ++i)
      for (std::size_t j = i + 1; j < colliders.size(); ++j) {
        const int a = static_cast<int>(i), b = static_cast<int>(j);
        const int joint = hand.links()[j].joint;
        const bool neighbours =
            joint >= 0 && hand.joints()[static_cast<std::size_t>(joint)].parent == a;
        ClosestDistance closest(0.002);
        bullet.contactPairTest(colliders[i].get(), colliders[j].get(), closest);
        if (neighbours || closest.distance < 0.002) filter.ignored.emplace_back(a, b);
      }
  }

  void add_drives() {
    leaders.assign(hand.dofs().size(), -1);
    for (int i = 0; i < static_cast<int>(hand.joints().size()); ++i) {
      const model::HandJoint& joint = hand.joints()[static_cast<std::size_t>(i)];
      const model::HandDof& dof = hand.dofs()[static_cast<std::size_t>(joint.dof)];
      auto& leader = leaders[static_cast<std::size_t>(joint.dof)];
      if (leader < 0 && joint.multiplier == 1 && joint.offset == 0) leader = i;
      auto motor =
          std::make_unique<btMultiBodyJointMotor>(multibody.get(), i, 0, joint.max_torque * dt());
      motor->setVelocityTarget(0, 1);
      motor->setRhsClamp(dof.max_velocity * std::abs(joint.multiplier));
      motor->finalizeMultiDof();  // otherwise its impulse cannot be read before the first step
      bullet.addMultiBodyConstraint(motor.get());
      motors.push_back(std::move(motor));
      auto limit = std::make_unique<btMultiBodyJointLimitConstraint>(multibody.get(), i,
                                                                     joint.lower, joint.upper);
      bullet.addMultiBodyConstraint(limit.get());
      limits.push_back(std::move(limit));
    }
  }

  /// Moves the hand there, at rest, and its colliders with it.
  void place(const Pose& X_WB, const VectorXd& dof) {
    set_hand(X_WB, hand.joint_angles(hand.clamp(dof)),
             VectorXd::Zero(static_cast<Eigen::Index>(hand.joints().size())));
    base_velocity.setZero();
    base_turn.setZero();
    X_WB_command = X_WB;
    dof_command = hand.clamp(dof);
  }

  void set_hand(const Pose& X_WB, const VectorXd& q, const VectorXd& v) {
    Pose X_WC = X_WB;  // Bullet's base sits in its centre of mass
    X_WC.translation() = X_WB * hand.links()[0].com_L;
    multibody->setBaseWorldTransform(to_bullet(X_WC));
    multibody->setBaseVel(btVector3(0, 0, 0));
    multibody->setBaseOmega(btVector3(0, 0, 0));
    for (int i = 0; i < q.size(); ++i) {
      multibody->setJointPos(i, q[i]);
      multibody->setJointVel(i, v[i]);
    }
    btAlignedObjectArray<btQuaternion> rotations;
    btAlignedObjectArray<btVector3> origins;
    multibody->forwardKinematics(rotations, origins);
    multibody->updateCollisionObjectWorldTransforms(rotations, origins);
  }

  Pose X_WB() const {
    Pose X = from_bullet(multibody->getBaseWorldTransform());
    X.translation() = X * Vector3d(-hand.links()[0].com_L);
    return X;
  }

  void drive() {
    const Vector3d& com = hand.links()[0].com_L;
    const Pose X_WC = from_bullet(multibody->getBaseWorldTransform());
    const Vector3d move = X_WB_command * com - X_WC.translation();
    const Eigen::AngleAxisd turn(
        Eigen::Matrix3d(X_WB_command.linear() * X_WC.linear().transpose()));
    base_velocity =
        follow(move, base_velocity, options.base_speed, options.base_acceleration, dt());
    base_turn = follow(turn.angle() * turn.axis(), base_turn, options.base_turn_speed,
                       options.base_turn_acceleration, dt());
    multibody->setBaseVel(to_bullet(base_velocity));
    multibody->setBaseOmega(to_bullet(base_turn));

    const VectorXd target = hand.joint_angles(dof_command);
    for (int i = 0; i < target.size(); ++i) {
      const model::HandJoint& joint = hand.joints()[static_cast<std::size_t>(i)];
      const double wanted = std::clamp(target[i], joint.lower, joint.upper);
      const double ahead = std::abs(wanted - multibody->getJointPos(i));
      // Only what closes is to be soft; a spread that gives way lets the object turn.
      const bool closes = hand.dofs()[static_cast<std::size_t>(joint.dof)].closing != 0;
      const double share =
          closes ? ahead / (std::abs(joint.multiplier) * options.full_squeeze) : 1.0;
      auto& motor = *motors[static_cast<std::size_t>(i)];
      motor.setMaxAppliedImpulse(joint.max_torque * std::clamp(share, least_drive, 1.0) * dt());
      motor.setPositionTarget(wanted, drive_gain);
    }
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
  if (!is_finite(X_WB)) return fail("the hand's pose must be finite", "world");
  if (dof.size() != static_cast<Eigen::Index>(hand.dofs().size()) || !dof.allFinite())
    return fail("the hand needs " + std::to_string(hand.dofs().size()) + " finite DoF values",
                "world");
  std::vector<analysis::Material> materials;
  for (const model::HandLink& link : hand.links()) {
    const auto material = analysis::material_from_string(link.material);
    if (!material)
      return fail("unknown material " + link.material, link.name,
                  "glass, metal, plastic, wood, rubber or stone");
    materials.push_back(*material);
  }
  auto state = std::make_unique<State>(hand, options);
  if (options.table) state->add_table();
  state->add_hand(materials);
  if (std::find(state->leaders.begin(), state->leaders.end(), -1) != state->leaders.end())
    return fail("a DoF is led by no joint", hand.name());
  state->place(X_WB, dof);
  return std::unique_ptr<World>(new World(std::move(state)));
}

std::unique_ptr<World> World::clone() const {
  const HandMotion motion = hand_motion();
  // What was valid once is valid again.
  std::unique_ptr<World> copy =
      std::move(*create(state_->hand, motion.X_WB, motion.dof, state_->options));
  copy->state_->set_hand(motion.X_WB, motion.joint, motion.velocity);
  copy->state_->base_velocity = state_->base_velocity;
  copy->state_->base_turn = state_->base_turn;
  copy->command(state_->X_WB_command, state_->dof_command);
  for (int i = 0; i < body_count(); ++i) {
    const BodyMotion moving = body_motion(i);
    copy->add_body(body(i), moving.X_WO);
    btRigidBody& rigid = *copy->state_->bodies.back().rigid;
    rigid.setLinearVelocity(to_bullet(moving.velocity));
    rigid.setAngularVelocity(to_bullet(moving.angular_velocity));
  }
  return copy;
}

Expected<int> World::add_body(const Body& body, const Pose& X_WO) {
  if (!model::is_valid(body.shape)) return fail("shape is not valid", body.name);
  if (!std::isfinite(body.mass) || body.mass < 0) return fail("mass must be 0 or more", body.name);
  if (!is_finite(X_WO)) return fail("pose must be finite", body.name);
  if (body.friction && !(*body.friction >= 0 && std::isfinite(*body.friction)))
    return fail("friction must be 0 or more", body.name);
  const auto material = analysis::material_from_string(body.material);
  if (!material) return fail("unknown material " + body.material, body.name);

  State::Placed placed{body, make_shape(body.shape), nullptr};
  btVector3 inertia(0, 0, 0);
  if (body.mass > 0) placed.shape->calculateLocalInertia(body.mass, inertia);
  btRigidBody::btRigidBodyConstructionInfo info(body.mass, nullptr, placed.shape.get(), inertia);
  info.m_startWorldTransform = to_bullet(X_WO);
  info.m_linearDamping = info.m_angularDamping = 0;
  placed.rigid = std::make_unique<btRigidBody>(info);
  const int index = body_count();
  state_->make_touchable(*placed.rigid, state_->add_surface(*material, body.friction, index, -1));
  state_->bullet.addRigidBody(placed.rigid.get());
  placed.rigid->setGravity(to_bullet(state_->options.gravity_W));
  state_->bodies.push_back(std::move(placed));
  set_object_damping(state_->options.object_damping);
  return index;
}

void World::move_body(int body, const Pose& X_WO) {
  btRigidBody& rigid = *state_->bodies[static_cast<std::size_t>(body)].rigid;
  rigid.setWorldTransform(to_bullet(X_WO));
  rigid.setInterpolationWorldTransform(to_bullet(X_WO));
  rigid.setLinearVelocity(btVector3(0, 0, 0));
  rigid.setAngularVelocity(btVector3(0, 0, 0));
  rigid.clearForces();
  state_->bullet.updateSingleAabb(&rigid);
}

void World::set_gravity(const Eigen::Vector3d& gravity_W) {
  state_->options.gravity_W = gravity_W;
  for (State::Placed& placed : state_->bodies) placed.rigid->setGravity(to_bullet(gravity_W));
}

const Eigen::Vector3d& World::gravity() const {
  return state_->options.gravity_W;
}

void World::set_object_damping(double per_second) {
  state_->options.object_damping = per_second;
  // Bullet takes the share of its velocity that a body loses in a second.
  const double share = 1 - std::exp(-per_second);
  for (State::Placed& placed : state_->bodies) placed.rigid->setDamping(share, share);
}

void World::place_hand(const Pose& X_WB, const Eigen::VectorXd& dof) {
  state_->place(X_WB, dof);
}

void World::command(const Pose& X_WB, const Eigen::VectorXd& dof) {
  state_->X_WB_command = X_WB;
  state_->dof_command = state_->hand.clamp(dof);
}

void World::hold_still() {
  const HandMotion motion = hand_motion();
  state_->X_WB_command = motion.X_WB;
  for (Eigen::Index i = 0; i < motion.dof.size(); ++i) {
    const bool moves =
        std::abs(motion.velocity[state_->leaders[static_cast<std::size_t>(i)]]) > 0.05;
    const double keep = moves ? 0 : state_->options.full_squeeze;
    state_->dof_command[i] =
        std::clamp(state_->dof_command[i], motion.dof[i] - keep, motion.dof[i] + keep);
  }
  state_->dof_command = state_->hand.clamp(state_->dof_command);
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
  HandMotion motion{state_->X_WB(), VectorXd(state_->dof_command.size()), VectorXd(count),
                    VectorXd(count), VectorXd(count)};
  for (int i = 0; i < count; ++i) {
    motion.joint[i] = state_->multibody->getJointPos(i);
    motion.velocity[i] = state_->multibody->getJointVel(i);
    motion.torque[i] =
        state_->motors[static_cast<std::size_t>(i)]->getAppliedImpulse(0) / time_step();
  }
  for (Eigen::Index i = 0; i < motion.dof.size(); ++i)
    motion.dof[i] = motion.joint[state_->leaders[static_cast<std::size_t>(i)]];
  return motion;
}

const Pose& World::commanded_base() const {
  return state_->X_WB_command;
}
const Eigen::VectorXd& World::commanded_dof() const {
  return state_->dof_command;
}
int World::body_count() const {
  return static_cast<int>(state_->bodies.size());
}

const Body& World::body(int index) const {
  return state_->bodies[static_cast<std::size_t>(index)].body;
}

BodyMotion World::body_motion(int index) const {
  const btRigidBody& rigid = *state_->bodies[static_cast<std::size_t>(index)].rigid;
  return {from_bullet(rigid.getWorldTransform()), from_bullet(rigid.getLinearVelocity()),
          from_bullet(rigid.getAngularVelocity())};
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
                     point.getAppliedImpulse() / time_step(), std::max(0.0, -point.getDistance())});
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
  for (const auto& collider : state_->colliders)
    bullet.contactPairTest(collider.get(),
                           state_->bodies[static_cast<std::size_t>(body)].rigid.get(), closest);
  return closest.distance;
}

}  // namespace prehend::grasping
