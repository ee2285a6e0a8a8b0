#include "hand_body.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <cmath>

#include "bullet.hpp"
#include "closest.hpp"

namespace prehend::grasping {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

// The base follows its command and is not moved by what the hand touches: it weighs so much that
// the reaction of fingers and objects is lost in its inertia.
constexpr double base_mass = 1000;     // kg
constexpr double base_inertia = 100;   // kg m²
constexpr double drive_gain = 0.1;     // share of a joint's error that the drive removes each step
constexpr double least_drive = 0.1;    // share of its torque that a drive may always use
constexpr double resting_gap = 0.002;  // m: links that are closer at rest never collide

}  // namespace

bool LinkPairFilter::needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const {
  const auto* first = static_cast<const btCollisionObject*>(a->m_clientObject);
  const auto* second = static_cast<const btCollisionObject*>(b->m_clientObject);
  const int i = surface_of(first).link, j = surface_of(second).link;
  if (i < 0 && j < 0) return !(first->isStaticObject() && second->isStaticObject());
  if (i < 0 || j < 0) return true;
  return std::find(ignored.begin(), ignored.end(), std::pair(std::min(i, j), std::max(i, j))) ==
         ignored.end();
}

HandBody::HandBody(const model::HandModel& hand, const std::vector<analysis::Material>& materials,
                   btMultiBodyDynamicsWorld& world, double time_step, double full_squeeze)
    : hand_(hand), world_(world), time_step_(time_step), full_squeeze_(full_squeeze) {
  world_.getPairCache()->setOverlapFilterCallback(&filter_);
  build_links();
  world_.addMultiBody(multibody_.get());
  build_colliders(materials);
  ignore_overlaps();
  for (auto& collider : colliders_)
    world_.addCollisionObject(collider.get(), btBroadphaseProxy::DefaultFilter,
                              btBroadphaseProxy::AllFilter);
  build_drives();
}

HandBody::~HandBody() {
  for (auto& motor : motors_) world_.removeMultiBodyConstraint(motor.get());
  for (auto& limit : limits_) world_.removeMultiBodyConstraint(limit.get());
  for (auto& collider : colliders_) world_.removeCollisionObject(collider.get());
  world_.removeMultiBody(multibody_.get());
  world_.getPairCache()->setOverlapFilterCallback(nullptr);
}

void HandBody::build_links() {
  const auto& joints = hand_.joints();
  multibody_ = std::make_unique<btMultiBody>(static_cast<int>(joints.size()), base_mass,
                                             btVector3(base_inertia, base_inertia, base_inertia),
                                             false, false);
  for (int i = 0; i < static_cast<int>(joints.size()); ++i) {
    const model::HandJoint& joint = joints[static_cast<std::size_t>(i)];
    const model::HandLink& link = hand_.links()[static_cast<std::size_t>(joint.child)];
    const model::HandLink& parent = hand_.links()[static_cast<std::size_t>(joint.parent)];
    multibody_->setupRevolute(
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
    surfaces_.push_back({materials[static_cast<std::size_t>(i)], std::nullopt, -1, i});
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
  for (std::size_t i = 0; i < colliders_.size(); ++i)
    for (std::size_t j = i + 1; j < colliders_.size(); ++j) {
      const int a = static_cast<int>(i), b = static_cast<int>(j);
      const int joint = hand_.links()[j].joint;
      const bool neighbours =
          joint >= 0 && hand_.joints()[static_cast<std::size_t>(joint)].parent == a;
      ClosestDistance closest(resting_gap);
      world_.contactPairTest(colliders_[i].get(), colliders_[j].get(), closest);
      if (neighbours || closest.distance < resting_gap) filter_.ignored.emplace_back(a, b);
    }
}

void HandBody::build_drives() {
  leaders_.assign(hand_.dofs().size(), -1);
  for (int i = 0; i < static_cast<int>(hand_.joints().size()); ++i) {
    const model::HandJoint& joint = hand_.joints()[static_cast<std::size_t>(i)];
    const model::HandDof& dof = hand_.dofs()[static_cast<std::size_t>(joint.dof)];
    auto& leader = leaders_[static_cast<std::size_t>(joint.dof)];
    if (leader < 0 && joint.multiplier == 1 && joint.offset == 0) leader = i;
    auto motor = std::make_unique<btMultiBodyJointMotor>(multibody_.get(), i, 0,
                                                         joint.max_torque * time_step_);
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
  btAlignedObjectArray<btQuaternion> rotations;
  btAlignedObjectArray<btVector3> origins;
  multibody_->forwardKinematics(rotations, origins);
  multibody_->updateCollisionObjectWorldTransforms(rotations, origins);
}

void HandBody::drive(const VectorXd& dof) {
  const VectorXd target = hand_.joint_angles(dof);
  for (int i = 0; i < target.size(); ++i) {
    const model::HandJoint& joint = hand_.joints()[static_cast<std::size_t>(i)];
    const double wanted = std::clamp(target[i], joint.lower, joint.upper);
    const double ahead = std::abs(wanted - multibody_->getJointPos(i));
    // Only what closes is to be soft; a spread that gives way lets the object turn.
    const bool closes = hand_.dofs()[static_cast<std::size_t>(joint.dof)].closing != 0;
    const double share = closes ? ahead / (std::abs(joint.multiplier) * full_squeeze_) : 1.0;
    auto& motor = *motors_[static_cast<std::size_t>(i)];
    motor.setMaxAppliedImpulse(joint.max_torque * std::clamp(share, least_drive, 1.0) * time_step_);
    motor.setPositionTarget(wanted, drive_gain);
  }
}

void HandBody::move_base(const Vector3d& velocity, const Vector3d& turning) {
  multibody_->setBaseVel(to_bullet(velocity));
  multibody_->setBaseOmega(to_bullet(turning));
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

double HandBody::torque(int i) const {
  return motors_[static_cast<std::size_t>(i)]->getAppliedImpulse(0) / time_step_;
}

}  // namespace prehend::grasping
