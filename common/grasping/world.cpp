#include "common/grasping/world.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletCollisionCommon.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "common/analysis/materials.hpp"
#include "common/analysis/wrench_space.hpp"
#include "common/grasping/bullet.hpp"
#include "common/grasping/closest.hpp"
#include "common/grasping/geared_solver.hpp"
#include "common/grasping/placed_body.hpp"
#include "common/grasping/placed_hand.hpp"
#include "common/grasping/surface.hpp"

namespace prehend::grasping {
namespace {

constexpr int max_bodies = 1000;

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
  WorldOptions options;

  // Destroyed from the bottom up: users before what they use.
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  GearedSolver solver;
  LinkPairFilter filter;
  std::deque<Surface> surfaces;  // of table and bodies; stable addresses
  btMultiBodyDynamicsWorld bullet{&dispatcher, &broadphase, &solver, &configuration};
  btStaticPlaneShape plane{btVector3(0, 0, 1), 0.0};
  std::unique_ptr<btRigidBody> table;
  std::vector<std::unique_ptr<PlacedHand>> hands;
  std::vector<PlacedBody> bodies;

  explicit State(const WorldOptions& world_options) : options(world_options) {
    bullet.setGravity(btVector3(0, 0, 0));  // of the hands, which their arms carry
    btContactSolverInfo& info = bullet.getSolverInfo();
    info.m_numIterations = options.iterations;
    info.m_erp = 0.2;
    info.m_erp2 = 0.2;
    info.m_globalCfm = 0;
    bullet.getPairCache()->setOverlapFilterCallback(&filter);
    if (options.table) add_table();
  }

  ~State() {
    for (PlacedBody& placed : bodies) bullet.removeRigidBody(placed.rigid.get());
    hands.clear();
    if (table) bullet.removeRigidBody(table.get());
  }

  double dt() const { return 1.0 / options.rate; }

  PlacedHand& hand(int number) { return *hands[static_cast<std::size_t>(number)]; }

  void add_table() {
    table =
        std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &plane));
    make_touchable(*table, surfaces.emplace_back());
    bullet.addRigidBody(table.get());
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
  std::unique_ptr<World> world(new World(std::make_unique<State>(options)));
  if (auto added = world->add_hand(hand, X_WB, dof); !added) return tl::unexpected(added.error());
  return world;
}

std::unique_ptr<World> World::clone() const {
  // What was valid once is valid again.
  WorldOptions options = state_->options;
  if (!options.push) options.base = {};
  std::unique_ptr<World> copy(new World(std::make_unique<State>(options)));
  State& to = *copy->state_;
  for (int i = 0; i < hand_count(); ++i) {
    static_cast<void>(copy->add_hand(hand(i), base(i), commanded_dof(i)));
    to.hand(i).copy_state(state_->hand(i));
  }
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

Expected<int> World::add_hand(const model::HandModel& hand, const Pose& X_WB,
                              const Eigen::VectorXd& dof) {
  const int number = hand_count();
  auto placed =
      PlacedHand::create(hand, number, X_WB, dof, state_->options, state_->bullet, state_->filter);
  if (!placed) return tl::unexpected(placed.error());
  state_->hands.push_back(std::move(*placed));
  return number;
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
                 state_->surfaces.emplace_back(Surface{*material, body.friction, index}));
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

Expected<void> World::place_hand(const Pose& X_WB, const VectorXd& dof, int hand) {
  return state_->hand(hand).place(X_WB, dof);
}
Expected<void> World::command(const Pose& X_WB, const VectorXd& dof, const Vector3d& velocity,
                              int hand) {
  return state_->hand(hand).command(X_WB, dof, velocity);
}
Expected<void> World::limit_effort(const VectorXd& effort, int hand) {
  return state_->hand(hand).limit_effort(effort);
}
void World::hold_still(int hand) {
  state_->hand(hand).hold_still();
}
void World::brake(int hand) {
  state_->hand(hand).brake();
}
void World::carry(const Pose& X_WB, const Push& most, int hand) {
  state_->hand(hand).carry(X_WB, most);
}
BaseLoad World::base_load(int hand) const {
  return state_->hand(hand).base_load();
}

void World::step() {
  for (auto& hand : state_->hands) hand->drive();
  state_->bullet.stepSimulation(state_->dt(), 0);
}

double World::time_step() const {
  return state_->dt();
}
int World::hand_count() const {
  return static_cast<int>(state_->hands.size());
}
const model::HandModel& World::hand(int hand) const {
  return state_->hand(hand).model();
}
HandMotion World::hand_motion(int hand) const {
  return state_->hand(hand).motion();
}
Pose World::base(int hand) const {
  return state_->hand(hand).body().X_WB();
}
const Pose& World::commanded_base(int hand) const {
  return state_->hand(hand).commanded_base();
}
const Eigen::VectorXd& World::commanded_dof(int hand) const {
  return state_->hand(hand).commanded_dof();
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
    found.push_back({hand(link.hand).links()[static_cast<std::size_t>(link.link)].name, X_OW * p_W,
                     X_OW.linear() * normal_W, point.m_combinedFriction,
                     point.getAppliedImpulse() / time_step(), std::max(0.0, -point.getDistance()),
                     point.m_combinedSpinningFriction});
    found.back().hand = link.hand;
  });
  return found;
}

std::vector<Touch> World::touches() const {
  std::vector<Touch> found;
  std::vector<std::vector<HandBody::LinkMotion>> moving(state_->hands.size());  // if touched
  const auto velocity = [&](const Surface& surface, const Vector3d& p_W) -> Vector3d {
    if (surface.hand >= 0) {
      auto& links = moving[static_cast<std::size_t>(surface.hand)];
      if (links.empty()) links = state_->hand(surface.hand).body().link_motions();
      return links[static_cast<std::size_t>(surface.link)].velocity_at(p_W);
    }
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
      if (link.hand < 0 || link.hand == other.hand) return;
      const Vector3d apart = velocity(other, p_W) - velocity(link, p_W);
      found.push_back({link.hand, link.link, other.body, p_W, sign * normal_W, sign * force_W,
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

bool World::hand_touches_anything(int hand) const {
  bool touches = false;
  state_->each_contact([&](const btManifoldPoint&, const Surface& a, const Surface& b) {
    touches |= (a.hand == hand) != (b.hand == hand);
  });
  return touches;
}

double World::distance_to_hand(int body, double most, int hand) const {
  ClosestDistance closest(most);
  auto& bullet = const_cast<btMultiBodyDynamicsWorld&>(state_->bullet);
  for (const auto& collider : state_->hand(hand).body().colliders())
    bullet.contactPairTest(collider.get(),
                           state_->bodies[static_cast<std::size_t>(body)].rigid.get(), closest);
  return closest.distance;
}

}  // namespace prehend::grasping
