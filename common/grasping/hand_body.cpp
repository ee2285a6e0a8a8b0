#include "common/grasping/hand_body.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <cmath>

#include "common/grasping/bullet.hpp"
#include "common/grasping/closest.hpp"
#include "common/model/hand_effort.hpp"

namespace prehend::grasping {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double drive_gain = 0.1;    // share of a joint's error that the drive removes each step
constexpr double min_drive = 0.1;     // share of its torque that a drive may always use
constexpr double slips_after = 0.02;  // s, that a joint must be blocked before its clutch lets go
// Shares of a DoF's squeeze: how far a finger that its clutch presses may still follow, how far it
// must be opened until the whole torque holds it, and the speed (per s) below which it is blocked.
constexpr double give = 0.13, yield = 0.07, blocked_speed = 0.33;
constexpr double goes_back = 0.1;      // share of a squeeze behind where its motor was: it opens
constexpr double resting_gap = 0.002;  // m: links that are closer at rest never collide

/// What the drive of each joint has: with what is geared to it, which it moves as well.
std::vector<double> drive_torques(const model::HandModel& hand) {
  std::vector<double> torque;
  for (const model::HandJoint& joint : hand.joints()) torque.push_back(joint.max_torque);
  for (const model::HandJoint& joint : hand.joints())
    if (joint.geared_to >= 0) {
      const auto to = static_cast<std::size_t>(joint.geared_to);
      torque[to] += joint.max_torque * std::abs(joint.multiplier / hand.joints()[to].multiplier);
    }
  return torque;
}

}  // namespace

bool LinkPairFilter::needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const {
  const auto* first = static_cast<const btCollisionObject*>(a->m_clientObject);
  const auto* second = static_cast<const btCollisionObject*>(b->m_clientObject);
  const Surface &one = surface_of(first), &other = surface_of(second);
  if (one.hand < 0 && other.hand < 0) return !(first->isStaticObject() && second->isStaticObject());
  return one.hand != other.hand || !ignores(one.hand, one.link, other.link);
}

bool LinkPairFilter::ignores(int hand, int a, int b) const {
  const auto& pairs = ignored.at(hand);
  return std::find(pairs.begin(), pairs.end(), std::pair(std::min(a, b), std::max(a, b))) !=
         pairs.end();
}

HandBody::HandBody(const model::HandModel& hand, const std::vector<analysis::Material>& materials,
                   btMultiBodyDynamicsWorld& world, LinkPairFilter& filter, double time_step,
                   const BaseBody& base, int number)
    : hand_(hand),
      world_(world),
      filter_(filter),
      time_step_(time_step),
      number_(number),
      max_effort_(model::max_effort(hand)),
      max_torque_(drive_torques(hand)) {
  build_links(base);
  world_.addMultiBody(multibody_.get());
  build_colliders(materials);
  ignore_overlaps();
  for (auto& collider : colliders_)
    world_.addCollisionObject(collider.get(), btBroadphaseProxy::DefaultFilter,
                              btBroadphaseProxy::AllFilter);
  build_drives();
}

HandBody::~HandBody() {
  for (auto& motor : motors_)
    if (motor) world_.removeMultiBodyConstraint(motor.get());
  for (auto& gear : gears_) world_.removeMultiBodyConstraint(gear.get());
  for (auto& limit : limits_) world_.removeMultiBodyConstraint(limit.get());
  for (auto& collider : colliders_) world_.removeCollisionObject(collider.get());
  world_.removeMultiBody(multibody_.get());
}

void HandBody::build_links(const BaseBody& base) {
  const auto& joints = hand_.joints();
  multibody_ = std::make_unique<btMultiBody>(static_cast<int>(joints.size()), base.mass,
                                             btVector3(base.inertia, base.inertia, base.inertia),
                                             false, false);
  for (int i = 0; i < static_cast<int>(joints.size()); ++i) {
    const model::HandJoint& joint = joints[static_cast<std::size_t>(i)];
    const model::HandLink& link = hand_.links()[static_cast<std::size_t>(joint.child)];
    const model::HandLink& parent = hand_.links()[static_cast<std::size_t>(joint.parent)];
    const auto setup = joint.kind == model::JointKind::prismatic ? &btMultiBody::setupPrismatic
                                                                 : &btMultiBody::setupRevolute;
    ((*multibody_).*setup)(
        i, link.mass, to_bullet(Vector3d(link.inertia_L.diagonal())), parent.joint,
        to_bullet(Eigen::Matrix3d(joint.X_PJ.linear())).inverse(), to_bullet(joint.axis_J),
        to_bullet(Vector3d(joint.X_PJ.translation() - parent.com_L)), to_bullet(link.com_L), true);
  }
  multibody_->finalizeMultiDof();
  multibody_->setHasSelfCollision(true);
  multibody_->setCanSleep(false);
  multibody_->setLinearDamping(0);
  multibody_->setAngularDamping(0);
  multibody_->setUseGyroTerm(false);
}

void HandBody::build_colliders(const std::vector<analysis::Material>& materials) {
  const auto& links = hand_.links();
  for (int i = 0; i < static_cast<int>(links.size()); ++i) {
    const model::HandLink& link = links[static_cast<std::size_t>(i)];
    auto compound = std::make_unique<btCompoundShape>();
    for (const model::CollisionShape& part : link.collision) {
      shapes_.push_back(make_shape(part.shape));
      Pose X_CS = part.X_LS;
      X_CS.translation() -= link.com_L;
      compound->addChildShape(to_bullet(X_CS), shapes_.back().get());
    }
    auto collider = std::make_unique<btMultiBodyLinkCollider>(multibody_.get(), link.joint);
    collider->setCollisionShape(compound.get());
    shapes_.push_back(std::move(compound));
    surfaces_.push_back({materials[static_cast<std::size_t>(i)], std::nullopt, -1, number_, i});
    make_touchable(*collider, surfaces_.back());
    if (link.joint < 0)
      multibody_->setBaseCollider(collider.get());
    else
      multibody_->getLink(link.joint).m_collider = collider.get();
    colliders_.push_back(std::move(collider));
  }
}

void HandBody::ignore_overlaps() {
  place(Pose::Identity(), hand_.joint_angles(hand_.postures().at("open")),
        VectorXd::Zero(static_cast<Eigen::Index>(hand_.joints().size())));
  auto& ignored = filter_.ignored[number_];
  for (std::size_t i = 0; i < colliders_.size(); ++i)
    for (std::size_t j = i + 1; j < colliders_.size(); ++j) {
      const int a = static_cast<int>(i), b = static_cast<int>(j);
      const int joint = hand_.links()[j].joint;
      const bool neighbours =
          joint >= 0 && hand_.joints()[static_cast<std::size_t>(joint)].parent == a;
      ClosestDistance closest(resting_gap);
      world_.contactPairTest(colliders_[i].get(), colliders_[j].get(), closest);
      if (neighbours || closest.distance < resting_gap) ignored.emplace_back(a, b);
    }
}

void HandBody::build_gear(int i) {
  const model::HandJoint& joint = hand_.joints()[static_cast<std::size_t>(i)];
  const model::HandJoint& to = hand_.joints()[static_cast<std::size_t>(joint.geared_to)];
  const double ratio = joint.multiplier / to.multiplier;
  gears_.push_back(std::make_unique<Gear>(multibody_.get(), i, joint.geared_to, ratio,
                                          joint.offset - ratio * to.offset));
  gears_.back()->finalizeMultiDof();
  world_.addMultiBodyConstraint(gears_.back().get());
}

void HandBody::build_drives() {
  clutches_.resize(hand_.dofs().size());
  for (int i = 0; i < static_cast<int>(hand_.joints().size()); ++i) {
    const model::HandJoint& joint = hand_.joints()[static_cast<std::size_t>(i)];
    const model::HandDof& dof = hand_.dofs()[static_cast<std::size_t>(joint.dof)];
    const model::HandJoint& leader = hand_.joints()[static_cast<std::size_t>(dof.joint)];
    auto& follower = clutches_[static_cast<std::size_t>(joint.dof)].follower;
    if (leader.breakaway && dof.closing != 0 && follower < 0 && i != dof.joint) follower = i;
    if (joint.geared_to >= 0) {  // the limits of what moves it are its own
      build_gear(i);
      motors_.push_back(nullptr);
      continue;
    }
    auto motor = std::make_unique<btMultiBodyJointMotor>(
        multibody_.get(), i, 0, max_torque_[static_cast<std::size_t>(i)] * time_step_);
    motor->setVelocityTarget(0, 1);
    motor->setRhsClamp(dof.max_velocity * std::abs(joint.multiplier));
    motor->finalizeMultiDof();  // otherwise its impulse cannot be read before the first step
    world_.addMultiBodyConstraint(motor.get());
    motors_.push_back(std::move(motor));
    auto limit = std::make_unique<btMultiBodyJointLimitConstraint>(multibody_.get(), i, joint.lower,
                                                                   joint.upper);
    world_.addMultiBodyConstraint(limit.get());
    limits_.push_back(std::move(limit));
  }
}

void HandBody::place(const Pose& X_WB, const VectorXd& joint, const VectorXd& velocity) {
  multibody_->setBaseWorldTransform(to_bullet(X_WC_of(X_WB)));
  multibody_->setBaseVel(btVector3(0, 0, 0));
  multibody_->setBaseOmega(btVector3(0, 0, 0));
  for (int i = 0; i < joint.size(); ++i) {
    multibody_->setJointPos(i, joint[i]);
    multibody_->setJointVel(i, velocity[i]);
  }
  for (Clutch& clutch : clutches_) clutch = {clutch.follower};
  move_colliders();
}

void HandBody::copy_state(const HandBody& other) {
  multibody_->setBasePos(other.multibody_->getBasePos());
  multibody_->setWorldToBaseRot(other.multibody_->getWorldToBaseRot());
  multibody_->setBaseVel(other.multibody_->getBaseVel());
  multibody_->setBaseOmega(other.multibody_->getBaseOmega());
  for (int i = 0; i < multibody_->getNumLinks(); ++i) {
    multibody_->setJointPos(i, other.joint(i));
    multibody_->setJointVel(i, other.velocity(i));
    const auto k = static_cast<std::size_t>(i);
    if (motors_[k])
      motors_[k]->internalSetAppliedImpulse(0, other.motors_[k]->getAppliedImpulse(0));
  }
  clutches_ = other.clutches_;
  move_colliders();
}

void HandBody::move_colliders() {
  btAlignedObjectArray<btQuaternion> rotations;
  btAlignedObjectArray<btVector3> origins;
  multibody_->forwardKinematics(rotations, origins);
  multibody_->updateCollisionObjectWorldTransforms(rotations, origins);
}

void HandBody::drive(const VectorXd& dof, const VectorXd& effort) {
  for (int i = 0; i < dof.size(); ++i) update_clutch(i, dof[i]);
  const VectorXd most = effort.size() > 0
                            ? VectorXd(effort.cwiseQuotient(max_effort_).cwiseMin(1.0))
                            : VectorXd::Ones(dof.size());
  const VectorXd target = hand_.joint_angles(dof);
  for (int i = 0; i < target.size(); ++i) {
    if (!motors_[static_cast<std::size_t>(i)]) continue;
    const model::HandJoint& joint = hand_.joints()[static_cast<std::size_t>(i)];
    const model::HandDof& led = hand_.dofs()[static_cast<std::size_t>(joint.dof)];
    double wanted = std::clamp(target[i], joint.lower, joint.upper);
    const double ahead = std::abs(wanted - multibody_->getJointPos(i));
    // Only what closes is to be soft; a spread that gives way lets the object turn.
    double share = led.closing != 0 ? ahead / (std::abs(joint.multiplier) * led.squeeze) : 1.0;
    const auto& [follower, blocked, released, farthest, locked] =
        clutches_[static_cast<std::size_t>(joint.dof)];
    double limit = most[joint.dof];
    if (locked && i == led.joint) {
      limit = share = 1;
      wanted = *locked;
    } else if (released && i == led.joint) {
      limit = 1;  // its gear holds it, whatever the motor may use
      wanted = std::clamp(*released + led.closing * give * led.squeeze, joint.lower, joint.upper);
      const double opened = led.closing * (*released - multibody_->getJointPos(i));
      const double pressed = *joint.breakaway / joint.max_torque;
      share = pressed + (1 - pressed) * std::clamp(opened / (yield * led.squeeze), 0.0, 1.0);
    }
    auto& motor = *motors_[static_cast<std::size_t>(i)];
    share = std::min(std::clamp(share, min_drive, 1.0), limit);
    motor.setMaxAppliedImpulse(max_torque_[static_cast<std::size_t>(i)] * share * time_step_);
    motor.setPositionTarget(wanted, drive_gain);
  }
}

void HandBody::update_clutch(int dof, double command) {
  Clutch& clutch = clutches_[static_cast<std::size_t>(dof)];
  if (clutch.follower < 0) return;
  const model::HandDof& led = hand_.dofs()[static_cast<std::size_t>(dof)];
  if (clutch.released) {
    const bool driven_back = led.closing * (command - *clutch.released) < 0 &&
                             led.closing * (motor(dof) - *clutch.released) <= 0;
    clutch.farthest = led.closing > 0 ? std::max(clutch.farthest, motor(dof))
                                      : std::min(clutch.farthest, motor(dof));
    const double ahead = led.closing * (command - clutch.farthest);
    if (driven_back)
      clutch = {clutch.follower};
    else if (ahead > 0)
      clutch.locked.reset();
    else if (!clutch.locked && ahead < -goes_back * led.squeeze)
      clutch.locked = joint(led.joint);  // its gear does not turn back, and nothing presses it on
    return;
  }
  const double breakaway = *hand_.joints()[static_cast<std::size_t>(led.joint)].breakaway;
  const bool blocked = led.closing * torque(led.joint) >= 0.999 * breakaway &&
                       std::abs(velocity(led.joint)) < blocked_speed * led.squeeze;
  clutch.blocked = blocked ? clutch.blocked + time_step_ : 0;
  if (clutch.blocked > slips_after) clutch.released = clutch.farthest = joint(led.joint);
}

double HandBody::motor(int dof) const {
  const model::HandDof& led = hand_.dofs()[static_cast<std::size_t>(dof)];
  const Clutch& clutch = clutches_[static_cast<std::size_t>(dof)];
  if (!clutch.released) return joint(led.joint);
  // The coupled joint may lag; the motor has come at least as far as where the clutch let go.
  const model::HandJoint& coupled = hand_.joints()[static_cast<std::size_t>(clutch.follower)];
  const double follows = (joint(clutch.follower) - coupled.offset) / coupled.multiplier;
  return led.closing > 0 ? std::max(*clutch.released, follows)
                         : std::min(*clutch.released, follows);
}

double HandBody::motor_velocity(int dof) const {
  const model::HandDof& led = hand_.dofs()[static_cast<std::size_t>(dof)];
  const Clutch& clutch = clutches_[static_cast<std::size_t>(dof)];
  if (!clutch.released) return velocity(led.joint);
  return velocity(clutch.follower) /
         hand_.joints()[static_cast<std::size_t>(clutch.follower)].multiplier;
}

std::vector<HandBody::LinkMotion> HandBody::link_motions() const {
  const auto count = static_cast<std::size_t>(multibody_->getNumLinks()) + 1;
  std::vector<btVector3> turning(count), velocity(count);  // of the base, then of each joint's link
  multibody_->compTreeLinkVelocities(turning.data(), velocity.data());
  std::vector<LinkMotion> motions;
  for (std::size_t i = 0; i < colliders_.size(); ++i) {
    const auto moved = static_cast<std::size_t>(hand_.links()[i].joint + 1);
    const btTransform& X_WC = colliders_[i]->getWorldTransform();
    motions.push_back({from_bullet(X_WC.getOrigin()),
                       from_bullet(X_WC.getBasis() * velocity[moved]),
                       from_bullet(X_WC.getBasis() * turning[moved])});
  }
  return motions;
}

void HandBody::move_base(const Vector3d& velocity, const Vector3d& turning) {
  multibody_->setBaseVel(to_bullet(velocity));
  multibody_->setBaseOmega(to_bullet(turning));
}

Vector3d HandBody::base_velocity() const {
  return from_bullet(multibody_->getBaseVel());
}

Vector3d HandBody::base_turning() const {
  return from_bullet(multibody_->getBaseOmega());
}

Pose HandBody::X_WB() const {
  Pose X = X_WC();
  X.translation() = X * Vector3d(-hand_.links()[0].com_L);
  return X;
}

Pose HandBody::X_WC() const {
  return from_bullet(multibody_->getBaseWorldTransform());
}

Pose HandBody::X_WC_of(const Pose& X_WB) const {
  Pose X_WC = X_WB;
  X_WC.translation() = X_WB * hand_.links()[0].com_L;
  return X_WC;
}

bool HandBody::may_touch(int link, int other) const {
  return !filter_.ignores(number_, link, other);
}

double HandBody::torque(int i) const {
  const auto& motor = motors_[static_cast<std::size_t>(i)];
  return motor ? motor->getAppliedImpulse(0) / time_step_ : 0;
}

}  // namespace prehend::grasping
