// Torques of the drives against what does not know of Newton and Euler's equations: potential
// energy at rest, the balance of power in motion (energies by finite differences), and the Jacobian
// for what pushes at the end.
#include "common/arm/dynamics.hpp"

#include <gtest/gtest.h>

#include "tests/support/arms/arms.hpp"

using namespace prehend;
using arm::Joints;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

const Vector3d gravity(0.3, -0.2, -9.7);  // of an arm that stands a little aslant

arm::Burden hand() {
  arm::Burden burden;
  burden.mass = 1.5;
  burden.com_L = Vector3d(0.02, -0.03, 0.1);
  burden.p_L = Vector3d(0.01, 0.02, 0.15);
  return burden;
}

double potential(const model::ArmModel& model, const Joints& q, const arm::Burden& burden) {
  const arm::Configuration at = arm::forward(model, q);
  double energy = -burden.mass * gravity.dot(at.X_AL[model.joints.size()] * burden.com_L);
  for (std::size_t i = 0; i <= model.joints.size(); ++i)
    energy -= model.links[i].mass * gravity.dot(at.X_AL[i] * model.links[i].com_L);
  return energy;
}

/// Where the joints are at a time, and what energy the arm then has.
struct Motion {
  const model::ArmModel& model;
  Joints q, v, a;
  arm::Burden burden = hand();

  Joints at(double t) const { return q + t * v + 0.5 * t * t * a; }
  double energy(double t) const {
    const double h = 1e-5;
    const auto before = arm::forward(model, at(t - h)), now = arm::forward(model, at(t)),
               after = arm::forward(model, at(t + h));
    const auto speed = [&](std::size_t link, const Vector3d& p_L) {
      return Vector3d((after.X_AL[link] * p_L - before.X_AL[link] * p_L) / (2 * h));
    };
    const std::size_t last = model.joints.size();
    double sum = 0.5 * burden.mass * speed(last, burden.com_L).squaredNorm();
    for (std::size_t i = 1; i <= last; ++i) {
      const model::ArmLink& link = model.links[i];
      const Matrix3d R = now.X_AL[i].linear();
      const Matrix3d spin =
          (after.X_AL[i].linear() - before.X_AL[i].linear()) / (2 * h) * R.transpose();
      const Vector3d turning(spin(2, 1), spin(0, 2), spin(1, 0));
      sum += 0.5 * link.mass * speed(i, link.com_L).squaredNorm() +
             0.5 * turning.dot(R * link.inertia_L * R.transpose() * turning);
    }
    return sum + potential(model, at(t), burden);
  }
};

Joints some(const model::ArmModel& model, Random& random, double most) {
  Joints values(static_cast<Eigen::Index>(model.joints.size()));
  for (double& value : values) value = random.uniform(-most, most);
  return values;
}

class DynamicsOf : public testing::TestWithParam<std::string> {
 protected:
  const model::ArmModel& model = test::arm(GetParam());
  const Joints zero = Joints::Zero(static_cast<Eigen::Index>(model.joints.size()));
};

TEST_P(DynamicsOf, AtRestHoldAgainstThePotential) {
  Random random(1);
  for (int k = 0; k < 20; ++k) {
    const Joints q = test::random_posture(model, random);
    const Joints torques = arm::drive_torques(model, q, zero, zero, hand(), gravity);
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      Joints more = q, less = q;
      more[i] += 1e-5, less[i] -= 1e-5;
      const double slope = (potential(model, more, hand()) - potential(model, less, hand())) / 2e-5;
      EXPECT_NEAR(torques[i], slope, 1e-5) << "joint " << i;
    }
  }
}

TEST_P(DynamicsOf, PowerIsWhatTheEnergyGains) {
  Random random(2);
  for (int k = 0; k < 20; ++k) {
    const Motion motion{model, test::random_posture(model, random), some(model, random, 1),
                        some(model, random, 3)};
    const double power =
        arm::drive_torques(model, motion.q, motion.v, motion.a, motion.burden, gravity)
            .dot(motion.v);
    const double gain = (motion.energy(1e-4) - motion.energy(-1e-4)) / 2e-4;
    EXPECT_NEAR(power, gain, 1e-3 * (1 + std::abs(gain)));
  }
}

TEST_P(DynamicsOf, WhatPushesIsHeldByTheJacobian) {
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    const Joints q = test::random_posture(model, random);
    arm::Burden pushed = hand();
    pushed.p_L = model.X_LE.translation();  // of which the Jacobian speaks
    const Joints alone = arm::drive_torques(model, q, zero, zero, pushed, gravity);
    pushed.force_A = random.normal3(20);
    pushed.torque_A = random.normal3(3);
    arm::Vector6 push;
    push << pushed.force_A, pushed.torque_A;
    const arm::Jacobian J = arm::jacobian(model, arm::forward(model, q));
    const Joints torques = arm::drive_torques(model, q, zero, zero, pushed, gravity);
    EXPECT_LT((torques - alone + J.transpose() * push).norm(), 1e-9);
  }
}

// Whichever way it pushes.
TEST_P(DynamicsOf, TheStrengthThatIsLeftIsEnoughInEveryDirection) {
  Random random(4);
  for (int k = 0; k < 20; ++k) {
    const Joints q = test::random_posture(model, random);
    arm::Burden pushed = hand();
    const Joints alone = arm::drive_torques(model, q, zero, zero, pushed, gravity);
    const arm::Strength left = arm::strength_left(model, q, alone, pushed.p_L);
    const Vector3d direction = random.normal3(1).normalized();
    for (const bool turns : {false, true}) {
      pushed.force_A = turns ? Vector3d::Zero() : Vector3d(left.force * direction);
      pushed.torque_A = turns ? Vector3d(left.torque * direction) : Vector3d::Zero();
      const Joints torques = arm::drive_torques(model, q, zero, zero, pushed, gravity);
      for (Eigen::Index i = 0; i < q.size(); ++i) {
        const double most = model.joints[static_cast<std::size_t>(i)].max_torque;
        if (most > 0 && std::abs(alone[i]) < most) {
          EXPECT_LE(std::abs(torques[i]), most + 1e-6) << "joint " << i;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, DynamicsOf, testing::ValuesIn(test::arm_names()));

}  // namespace
