// Measures whose values are known in closed form: what linear algebra and linear programs leave of
// them is 1e-9 for singular values and 1e-7 for the programs, whose solver misses its constraints
// by at most 1e-9 of numbers near one.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/analysis/approach.hpp"
#include "common/analysis/contact_wrenches.hpp"
#include "common/analysis/grasp_map.hpp"
#include "common/analysis/grip_forces.hpp"
#include "common/analysis/linear_program.hpp"
#include "common/analysis/resistance.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/analysis/grasps.hpp"

namespace {

using namespace prehend;
using namespace prehend::analysis;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double radius = 0.03;

/// Two contacts that face each other along x, with an edge along z.
std::vector<Contact> pinch(double friction, double torsion = 0) {
  std::vector<Contact> contacts;
  for (const double side : {1.0, -1.0}) {
    Contact contact{"finger", {side * radius, 0, 0}, {-side, 0, 0}, friction, 1, 0};
    contact.torsion = torsion;
    contact.tangent_O = Vector3d::UnitZ();
    contacts.push_back(contact);
  }
  return contacts;
}

/// Each contact is pushed along its normal by a joint of its own.
MatrixXd normal_drives(const std::vector<Contact>& contacts) {
  MatrixXd jacobian = MatrixXd::Zero(4 * static_cast<Eigen::Index>(contacts.size()),
                                     static_cast<Eigen::Index>(contacts.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    jacobian.block<3, 1>(4 * k, k) = contacts[i].normal_O;
  }
  return jacobian;
}

Wrench wrench(double fx, double fy, double fz, double tx = 0, double ty = 0, double tz = 0) {
  Wrench made;
  made << fx, fy, fz, tx, ty, tz;
  return made;
}

TEST(FrictionEdges, LieOnTheConeOfTheirModel) {
  Random random(31);
  for (Contact contact : random_grasp(random, 10)) {
    const Vector3d n = contact.normal_O.normalized();
    for (const double torsion : {0.0, 0.004}) {
      contact.torsion = torsion;
      const Eigen::Matrix4Xd edges = friction_edges(contact, 6);
      EXPECT_EQ(edges.cols(), torsion > 0 ? 20 : 6);
      for (const auto& edge : edges.colwise()) {
        const Vector3d f = edge.head<3>();
        EXPECT_NEAR(f.dot(n), 1, 1e-12);
        const double tangential = (f - n).squaredNorm() / std::pow(contact.friction, 2);
        const double turning = torsion > 0 ? std::pow(edge[3] / torsion, 2) : 0;
        EXPECT_NEAR(tangential + turning, 1, 1e-12);
      }
    }
  }
  Contact smooth{"", {0, 0, 0.1}, {0, 0, -1}, 0, 1, 0};
  EXPECT_EQ(friction_edges(smooth), Eigen::Vector4d(0, 0, -1, 0));
}

TEST(FrictionEdges, TorsionClosesAPinch) {
  // Two points leave the turn about their line free; soft fingers resist it by torsion / ρ, in the
  // L1 sense by one of them at a time. The corners between pole and ring cut off less than 1 %.
  const double rho = radius, torsion = 0.002;
  const auto point = l1_resistance(contact_wrenches(pinch(1), rho));
  const auto soft = l1_resistance(contact_wrenches(pinch(1, torsion), rho));
  ASSERT_TRUE(point && soft);
  EXPECT_FALSE(point->force_closure);
  ASSERT_TRUE(soft->force_closure);
  EXPECT_LE(soft->epsilon, torsion / rho + 1e-9);
  EXPECT_GE(soft->epsilon, 0.99 * torsion / rho);
  EXPECT_GT(std::abs(soft->weakest_direction[3]), 0.99);
}

TEST(FrictionEdges, SoftFingersAreNeverWorseThanPoints) {
  Random random(32);
  for (int trial = 0; trial < 30; ++trial) {
    auto contacts = random_grasp(random, 5);
    double last = -1;
    for (const double torsion : {0.0, 0.001, 0.01}) {
      for (Contact& contact : contacts) contact.torsion = torsion;
      const auto q = l1_resistance(contact_wrenches(contacts, 0.06));
      ASSERT_TRUE(q);
      EXPECT_GE(q->epsilon, last - 1e-9);
      last = q->epsilon;
    }
  }
}

TEST(GraspMap, SixFrictionlessContactsOnACubeAreRankThree) {
  // All normals meet in the centre: no torque, all forces with singular value sqrt(2).
  std::vector<Contact> contacts;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {1.0, -1.0})
      contacts.push_back({"", side * Vector3d::Unit(axis), -side * Vector3d::Unit(axis), 0, 1, 0});
  const VectorXd s = Eigen::JacobiSVD<MatrixXd>(grasp_map(contacts, 1)).singularValues();
  EXPECT_NEAR(s[2], std::numbers::sqrt2, 1e-9);
  EXPECT_NEAR(s[3], 0, 1e-9);
  EXPECT_EQ(transmission(grasp_map(contacts, 1)).isotropy, 0);
  EXPECT_EQ(internal_force_dimension(contacts, 1), 3);
  // With friction: σ² = 6 for forces, and for each torque the four contacts off its axis give 4.
  for (Contact& contact : contacts) contact.friction = 1;
  const Transmission with = transmission(grasp_map(contacts, 1));
  EXPECT_NEAR(with.smallest, 2, 1e-9);
  EXPECT_NEAR(with.isotropy, 2 / std::sqrt(6.0), 1e-9);
  EXPECT_NEAR(with.volume, std::pow(6.0, 1.5) * 8, 1e-7);
  EXPECT_EQ(internal_force_dimension(contacts, 1), 12);
}

TEST(GraspMap, PinchHasOneInternalForceAndSoftFingersTwo) {
  EXPECT_EQ(internal_force_dimension(pinch(0.5), radius), 1);
  EXPECT_EQ(internal_force_dimension(pinch(0.5, 0.001), radius), 2);
  EXPECT_EQ(internal_force_dimension({}, radius), 0);
}

TEST(GraspMap, JacobianIsTheDerivativeOfTheContactPoints) {
  const auto hand = model::HandModel::load(test::in_sources("common/models/hands/barrett"));
  ASSERT_TRUE(hand) << hand.error().message();
  const Pose X_BO =
      make_pose(Vector3d(0.01, -0.02, 0.09), Eigen::Quaterniond(0.8, 0.2, -0.4, 0.1).normalized());
  const VectorXd q = hand->joint_angles(hand->postures().at("open")).array() + 0.2;
  std::vector<Contact> contacts;
  for (const auto& tip : hand->fingertips()) {
    const auto& link = hand->links()[static_cast<std::size_t>(tip.link)];
    const Vector3d p_B = hand->link_poses(q)[static_cast<std::size_t>(tip.link)] * tip.p_LT;
    contacts.push_back({link.name, X_BO.inverse() * p_B, {1, 0, 0}, 0.5, 1, 0});
  }
  const auto jacobian = contact_jacobian(*hand, q, X_BO, contacts);
  ASSERT_TRUE(jacobian) << jacobian.error().message();
  const double step = 1e-6;
  for (Eigen::Index j = 0; j < q.size(); ++j) {
    VectorXd ahead = q, behind = q;
    ahead[j] += step;
    behind[j] -= step;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const auto link = static_cast<std::size_t>(hand->fingertips()[i].link);
      const Vector3d& p_LT = hand->fingertips()[i].p_LT;
      const Vector3d moved =
          hand->link_poses(ahead)[link] * p_LT - hand->link_poses(behind)[link] * p_LT;
      const Vector3d numeric = X_BO.linear().transpose() * moved / (2 * step);
      const auto row = 4 * static_cast<Eigen::Index>(i);
      EXPECT_LT((jacobian->block<3, 1>(row, j) - numeric).norm(), 1e-8);
    }
  }
  // The motor of a DoF does the work of all joints that it couples.
  const VectorXd dof =
      VectorXd::LinSpaced(static_cast<Eigen::Index>(hand->dofs().size()), 0.1, 0.4);
  EXPECT_LT((coupling(*hand) * dof -
             (hand->joint_angles(dof) - hand->joint_angles(VectorXd::Zero(dof.size()))))
                .norm(),
            1e-12);
  contacts[0].link = "nowhere";
  EXPECT_FALSE(contact_jacobian(*hand, q, X_BO, contacts));
  contacts.erase(contacts.begin());
  EXPECT_FALSE(contact_jacobian(*hand, VectorXd::Zero(1), X_BO, contacts));
}

TEST(GraspMap, ContactsThatMoveWithTheObjectMoveItSo) {
  // "Joints" that move all contacts as a rigid body would: H must be that very motion.
  Random random(33);
  auto contacts = random_grasp(random, 5);
  for (Contact& contact : contacts) contact.torsion = 0.003;
  const double rho = 0.06;
  MatrixXd jacobian(4 * static_cast<Eigen::Index>(contacts.size()), 6);
  for (std::size_t i = 0; i < contacts.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      const auto row = 4 * static_cast<Eigen::Index>(i);
      const Vector3d unit = Vector3d::Unit(axis);
      jacobian.block<4, 1>(row, axis) << unit, 0;
      jacobian.block<4, 1>(row, 3 + axis) << unit.cross(contacts[i].p_OC),
          unit.dot(contacts[i].normal_O);
    }
  Wrench scale = Wrench::Ones();
  scale.tail<3>().setConstant(rho);
  const MatrixXd H = object_jacobian(contacts, rho, jacobian, MatrixXd::Identity(6, 6));
  EXPECT_LT((H - MatrixXd(scale.asDiagonal())).norm(), 1e-9);
  EXPECT_NEAR(transmission(H).volume, std::pow(rho, 3), 1e-12);
}

TEST(GripForces, PinchHoldsAWeightByFriction) {
  // Two contacts hold a weight across their line: normal force N = weight / (2 μ) each.
  for (const double mu : {0.25, 0.5, 1.0}) {
    const auto contacts = pinch(mu);
    const auto grip =
        least_torques(contacts, wrench(0, 0, -2.0), normal_drives(contacts), Eigen::Vector2d(4, 8));
    ASSERT_TRUE(grip) << grip.error().message();
    ASSERT_TRUE(*grip);
    EXPECT_NEAR((*grip)->torques[0], 1 / mu, 1e-7);
    EXPECT_NEAR((*grip)->torques[1], 1 / mu, 1e-7);
    EXPECT_NEAR((*grip)->effort, 1 / mu / 4, 1e-7);  // of the weaker drive
    EXPECT_NEAR((*grip)->forces(2, 0) + (*grip)->forces(2, 1), 2, 1e-7);
  }
}

TEST(GripForces, RoundingIsNoConstraint) {
  // Rows that should be zero but hold rounding were once scaled up by the solver, and a pinch whose
  // contacts came from sines and cosines held nothing.
  for (const double load : {1e-6, 1.0, 1e6}) {
    for (int turn = 0; turn < 12; ++turn) {
      auto contacts = pinch(0.5);
      const Eigen::Matrix3d R =
          Eigen::AngleAxisd(0.5 * turn, Vector3d(1, 2, 3).normalized()).matrix();
      for (Contact& contact : contacts) {
        contact.p_OC = R * contact.p_OC;
        contact.normal_O = R * contact.normal_O;
        contact.tangent_O = R * contact.tangent_O;
      }
      Wrench weight = Wrench::Zero();
      weight.head<3>() = -load * R.col(2);
      const auto grip =
          least_torques(contacts, weight, normal_drives(contacts), Eigen::Vector2d(1, 1));
      ASSERT_TRUE(grip && *grip) << load << " " << turn;
      EXPECT_NEAR((*grip)->effort, load, 1e-6 * load);
    }
  }
}

TEST(GripForces, LeversAndLoadsAlongTheNormal) {
  // Pushed along the line with 3 N against a finger on a lever of 0.1 m: 0.3 N m there, 0 opposite.
  const auto contacts = pinch(0.5);
  const auto grip = least_torques(contacts, wrench(3, 0, 0), 0.1 * normal_drives(contacts),
                                  Eigen::Vector2d(1, 1));
  ASSERT_TRUE(grip && *grip);
  EXPECT_NEAR((*grip)->torques[0], 0.3, 1e-7);
  EXPECT_NEAR((*grip)->torques[1], 0, 1e-7);
  EXPECT_NEAR((*grip)->effort, 0.3, 1e-7);
}

TEST(GripForces, WhatFrictionCannotHoldIsNoFailure) {
  const auto smooth = pinch(0);
  const auto slips =
      least_torques(smooth, wrench(0, 0, -1), normal_drives(smooth), Eigen::Vector2d(1, 1));
  ASSERT_TRUE(slips) << slips.error().message();
  EXPECT_FALSE(*slips);
  // Points cannot hold a moment about their line, soft fingers can, with N = M / (2 torsion).
  const auto points = pinch(1), soft = pinch(1, 0.002);
  const Wrench moment = wrench(0, 0, 0, 0.01);
  const auto turns = least_torques(points, moment, normal_drives(points), Eigen::Vector2d(1, 1));
  ASSERT_TRUE(turns);
  EXPECT_FALSE(*turns);
  const auto holds = least_torques(soft, moment, normal_drives(soft), Eigen::Vector2d(1, 1));
  ASSERT_TRUE(holds && *holds);
  EXPECT_NEAR((*holds)->effort, 0.01 / 0.004, 1e-6);  // more than the drives have: still told
  const auto none = least_torques({}, wrench(0, 0, -1), MatrixXd(0, 2), Eigen::Vector2d(1, 1));
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
}

TEST(GripForces, BalanceTheLoadWithinTheCones) {
  Random random(34);
  int held = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const auto contacts = random_grasp(random, 4);
    const Wrench load = wrench(random.normal(), random.normal(), random.normal(),
                               0.02 * random.normal(), 0.02 * random.normal(), 0);
    MatrixXd jacobian(16, 7);
    for (Eigen::Index i = 0; i < jacobian.size(); ++i) jacobian(i) = 0.05 * random.normal();
    const VectorXd limits = VectorXd::LinSpaced(7, 0.2, 0.8);
    const auto grip = least_torques(contacts, load, jacobian, limits);
    ASSERT_TRUE(grip) << grip.error().message();
    if (!*grip) continue;
    ++held;
    Wrench sum = load;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Eigen::Vector4d c = (*grip)->forces.col(static_cast<Eigen::Index>(i));
      sum += contact_map(contacts[i], 1) * c;
      const double normal = c.head<3>().dot(contacts[i].normal_O);
      EXPECT_GE(normal, -1e-9);
      EXPECT_LE((c.head<3>() - normal * contacts[i].normal_O).norm(),
                contacts[i].friction * normal + 1e-7);
    }
    EXPECT_LT(sum.norm(), 1e-6 * (1 + load.norm()));
    // No other combination of balanced forces is cheaper: a little more torque limit everywhere
    // costs as much less, so the effort scales exactly.
    const auto half = least_torques(contacts, load, jacobian, 2 * limits);
    ASSERT_TRUE(half && *half);
    EXPECT_NEAR(2 * (*half)->effort, (*grip)->effort, 1e-6 * (1 + (*grip)->effort));
    const auto twice = least_torques(contacts, 2 * load, jacobian, limits);
    ASSERT_TRUE(twice && *twice);
    EXPECT_NEAR((*twice)->effort, 2 * (*grip)->effort, 1e-6 * (1 + (*grip)->effort));
  }
  EXPECT_GT(held, 10);
}

TEST(GripForces, SqueezeMarginAgreesWithForceClosure) {
  Random random(35);
  int closed = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const auto contacts = random_grasp(random, 3 + trial % 3);
    const auto squeeze = best_squeeze(contacts);
    const auto epsilon = l1_resistance(contact_wrenches(contacts, 0.06));
    ASSERT_TRUE(squeeze && epsilon);
    const bool inside = *squeeze && (*squeeze)->margin > 1e-9;
    EXPECT_EQ(inside, epsilon->force_closure);
    closed += inside;
    if (!inside) continue;
    Wrench sum = Wrench::Zero();
    for (std::size_t i = 0; i < contacts.size(); ++i)
      sum += contact_map(contacts[i], 0.06) * (*squeeze)->forces.col(static_cast<Eigen::Index>(i));
    EXPECT_LT(sum.norm(), 1e-6);
  }
  EXPECT_GT(closed, 5);
  // Facing contacts use all 16 edges alike; contacts side by side cannot squeeze.
  const auto best = best_squeeze(pinch(0.5));
  ASSERT_TRUE(best && *best);
  EXPECT_NEAR((*best)->margin, 1.0 / 16, 1e-7);
  auto beside = pinch(0.5);
  beside[1].normal_O = beside[0].normal_O;
  const auto none = best_squeeze(beside);
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
}

TEST(GripForces, RefusesWhatDoesNotFit) {
  const auto contacts = pinch(0.5);
  const Wrench load = wrench(0, 0, 1);
  const MatrixXd drives = normal_drives(contacts);
  EXPECT_FALSE(least_torques(contacts, load, MatrixXd::Zero(4, 2), Eigen::Vector2d(1, 1)));
  EXPECT_FALSE(least_torques(contacts, load, drives, Eigen::Vector2d(1, 0)));
  EXPECT_FALSE(least_torques(contacts, load, drives, VectorXd::Ones(3)));
  Wrench bad = load;
  bad[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(least_torques(contacts, bad, drives, Eigen::Vector2d(1, 1)));
}

TEST(LinearProgram, BestInfeasibleAndUnbounded) {
  // max x + y with x + 2y <= 4, 3x + y <= 6: the corner (1.6, 1.2).
  LinearProgram program(2, 2);
  program.cost << -1, -1;
  program.rows << 1, 2, 3, 1;
  program.row_lower.setConstant(-std::numeric_limits<double>::infinity());
  program.row_upper << 4, 6;
  const auto best = minimise(program);
  ASSERT_TRUE(best && *best);
  EXPECT_NEAR((**best)[0], 1.6, 1e-9);
  EXPECT_NEAR((**best)[1], 1.2, 1e-9);
  program.row_upper[0] = -1;  // x + 2y <= -1 has no solution without negative x or y
  const auto none = minimise(program);
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
  program.row_upper.setConstant(std::numeric_limits<double>::infinity());
  EXPECT_FALSE(minimise(program));
  program.cost[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(minimise(program));
}

TEST(Approach, SkewnessIsTheAngleToTheNearestPrincipalAxis) {
  const model::Shape box{model::ShapeKind::box, {0.05, 0.1, 0.2}};
  const model::Shape can{model::ShapeKind::cylinder, {0.03, 0.03, 0.2}};
  const model::Shape ball{model::ShapeKind::sphere, {0.03, 0.03, 0.03}};
  EXPECT_NEAR(skewness(box, {0, -2, 0}), 0, 1e-9);
  EXPECT_NEAR(skewness(box, {1, 1, 1}), std::acos(1 / std::sqrt(3.0)), 1e-9);
  EXPECT_NEAR(skewness(box, {std::sin(0.3), 0, std::cos(0.3)}), 0.3, 1e-9);
  EXPECT_NEAR(skewness(can, {1, 2, 0}), 0, 1e-7);  // across the cylinder, whichever way
  EXPECT_NEAR(skewness(can, {0.6, 0.8, 1}), std::numbers::pi / 4, 1e-9);
  EXPECT_NEAR(skewness(ball, {0.1, -0.7, 0.3}), 0, 1e-7);
  // The object's axes may lie anyhow.
  const Eigen::Matrix3d R = Eigen::Quaterniond(0.5, 0.1, -0.7, 0.3).normalized().matrix();
  const Eigen::Matrix3d moments = R * Vector3d(1, 2, 3).asDiagonal() * R.transpose();
  EXPECT_NEAR(skewness(moments, R * Vector3d(0, std::cos(0.2), std::sin(0.2))), 0.2, 1e-9);
}

}  // namespace
