// ε by the growing hull must be the ε of Qhull's full hull: both displace points by about 1e-11 of
// the wrenches' size to resolve coplanar ones, which moves ε by at most as much; 1e-9 leaves room
// for wrenches of norm ten. Where the hull is a known body ε is known, to the same tolerance.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "common/analysis/wrench_space.hpp"
#include "tests/unit/analysis/grasps.hpp"

namespace {

using namespace prehend;
using namespace prehend::analysis;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

bool long_round() {
  return std::getenv("PREHEND_LONG") != nullptr;
}

/// Compares both ways on these wrenches; whether there was force closure.
bool expect_same(const MatrixXd& wrenches) {
  const auto full = wrench_quality(wrenches);
  const auto fast = l1_resistance(wrenches);
  EXPECT_TRUE(full) << full.error().message();
  EXPECT_TRUE(fast) << fast.error().message();
  if (!full || !fast) return false;
  EXPECT_NEAR(fast->epsilon, full->epsilon, 1e-9);
  EXPECT_EQ(fast->force_closure, full->force_closure);
  if (!fast->force_closure) {
    EXPECT_EQ(fast->weakest_direction, VectorXd::Zero(wrenches.rows()));
    return false;
  }
  EXPECT_NEAR(fast->weakest_direction.norm(), 1, 1e-12);
  EXPECT_NEAR((-fast->weakest_direction.transpose() * wrenches).maxCoeff(), fast->epsilon, 1e-12);
  return true;
}

TEST(Resistance, SameAsTheFullHullOnRandomGrasps) {
  const int trials = long_round() ? 10000 : 400;
  Random random(21);
  int closed = 0;
  for (int trial = 0; trial < trials && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    const auto contacts = random_grasp(random, 2 + static_cast<int>(random.index(9)));
    closed += expect_same(contact_wrenches(contacts, 0.06));
  }
  EXPECT_GT(closed, trials / 3);
  EXPECT_LT(closed, trials);
}

TEST(Resistance, SameAsTheFullHullOnSymmetricGrasps) {
  const int trials = long_round() ? 1000 : 100;
  Random random(22);
  int closed = 0;
  for (int trial = 0; trial < trials && !HasFailure(); ++trial) {
    SCOPED_TRACE(trial);
    closed += expect_same(contact_wrenches(symmetric_grasp(random, trial), 0.05));
  }
  EXPECT_GT(closed, trials / 3);
}

TEST(Resistance, SameAsTheFullHullInAnyDimension) {
  Random random(23);
  for (int dimension = 2; dimension <= 6; ++dimension)
    for (int trial = 0; trial < 20; ++trial) {
      MatrixXd w(dimension, dimension + 1 + static_cast<int>(random.index(40)));
      for (Eigen::Index i = 0; i < w.size(); ++i) w(i) = random.normal();
      SCOPED_TRACE(dimension);
      expect_same(w);
    }
}

TEST(Resistance, KnownBodies) {
  for (int dimension = 2; dimension <= 6; ++dimension) {
    MatrixXd cross(dimension, 2 * dimension);
    cross << MatrixXd::Identity(dimension, dimension), -MatrixXd::Identity(dimension, dimension);
    const auto q = l1_resistance(cross);
    ASSERT_TRUE(q);
    EXPECT_NEAR(q->epsilon, 1 / std::sqrt(dimension), 1e-9);
    // A cube has 2 d facets of which each holds 2^(d-1) corners: all but d are too many in a plane.
    MatrixXd cube(dimension, 1 << dimension);
    for (int corner = 0; corner < cube.cols(); ++corner)
      for (int axis = 0; axis < dimension; ++axis) cube(axis, corner) = corner >> axis & 1 ? 2 : -2;
    const auto c = l1_resistance(cube);
    ASSERT_TRUE(c);
    EXPECT_NEAR(c->epsilon, 2, 1e-9);
    EXPECT_NEAR(c->weakest_direction.cwiseAbs().maxCoeff(), 1, 1e-9);
  }
}

TEST(Resistance, ScalesWithTheWrenches) {
  Random random(24);
  const MatrixXd w = contact_wrenches(random_grasp(random, 8), 0.06);
  const auto one = l1_resistance(w);
  ASSERT_TRUE(one && one->force_closure);
  for (const double scale : {1e-3, 7.0, 1e6}) {
    const auto scaled = l1_resistance(scale * w);
    ASSERT_TRUE(scaled);
    EXPECT_NEAR(scaled->epsilon, scale * one->epsilon, 1e-10 * scale);
  }
}

TEST(Resistance, TurningOrEnlargingTheObjectChangesNothing) {
  // Turned contacts have turned wrenches: forces and torques by the same rotation, so all lengths
  // stay. Enlarged ones have the same wrenches, because ρ grows as well. A moved origin, though, is
  // another object: its torques are about another centre of mass.
  Random random(29);
  for (int trial = 0; trial < 20; ++trial) {
    auto contacts = random_grasp(random, 6);
    for (Contact& contact : contacts) contact.tangent_O = random.normal3(1);
    const auto before = l1_resistance(contact_wrenches(contacts, 0.06));
    const double scale = random.uniform(0.1, 10);
    const Eigen::Matrix3d R =
        Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
            .normalized()
            .matrix();
    for (Contact& contact : contacts) {
      contact.p_OC = scale * (R * contact.p_OC);
      contact.normal_O = R * contact.normal_O;
      contact.tangent_O = R * contact.tangent_O;
    }
    const auto after = l1_resistance(contact_wrenches(contacts, scale * 0.06));
    ASSERT_TRUE(before && after);
    EXPECT_NEAR(after->epsilon, before->epsilon, 1e-9);
    if (!before->force_closure) continue;
    const Vector3d turned = R * before->weakest_direction.head<3>();
    EXPECT_LT((after->weakest_direction.head<3>() - turned).norm(), 1e-6);
  }
}

TEST(Resistance, AnotherContactNeverHurts) {
  Random random(25);
  for (int trial = 0; trial < 20; ++trial) {
    const auto contacts = random_grasp(random, 10);
    double last = -1;
    for (std::size_t count = 1; count <= contacts.size(); ++count) {
      const auto q = l1_resistance(
          contact_wrenches(std::vector<Contact>(contacts.begin(), contacts.begin() + count), 0.06));
      ASSERT_TRUE(q);
      EXPECT_GE(q->epsilon, last - 1e-9);
      last = q->epsilon;
    }
  }
}

TEST(Resistance, FlatAndEmptyHaveNoForceClosure) {
  Random random(26);
  const MatrixXd one_contact = contact_wrenches(random_grasp(random, 1), 0.06);
  MatrixXd coplanar = MatrixXd::Random(6, 40);
  coplanar.row(4) = coplanar.row(0) - 2 * coplanar.row(3);
  for (const MatrixXd& w : {MatrixXd(6, 0), MatrixXd(MatrixXd::Zero(6, 30)), one_contact, coplanar,
                            MatrixXd(MatrixXd::Constant(6, 30, 0.3))}) {
    const auto q = l1_resistance(w);
    ASSERT_TRUE(q) << q.error().message();
    EXPECT_EQ(q->epsilon, -1);
    EXPECT_FALSE(q->force_closure);
  }
}

TEST(Resistance, RefusesWhatCannotBeMeasured) {
  MatrixXd w = MatrixXd::Random(6, 20);
  w(3, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(l1_resistance(w));
  EXPECT_FALSE(linf_resistance({w}));
  w(3, 3) = 1e300;
  EXPECT_FALSE(l1_resistance(w));
  EXPECT_FALSE(l1_resistance(MatrixXd::Random(7, 30)));
  EXPECT_FALSE(linf_resistance({MatrixXd::Random(6, 8), MatrixXd::Random(3, 8)}));
}

std::vector<MatrixXd> by_contact(const std::vector<Contact>& contacts, double scale, int edges) {
  std::vector<MatrixXd> made;
  for (const Contact& contact : contacts) made.push_back(edge_wrenches(contact, scale, edges));
  return made;
}

/// Every sum of one wrench, or none, of each contact: the corners of the L∞ wrench space.
MatrixXd minkowski_sum(const std::vector<MatrixXd>& parts) {
  MatrixXd sum = MatrixXd::Zero(6, 1);
  for (const MatrixXd& part : parts) {
    MatrixXd next = sum;
    for (Eigen::Index k = 0; k < part.cols(); ++k) {
      next.conservativeResize(Eigen::NoChange, next.cols() + sum.cols());
      next.rightCols(sum.cols()) = sum.colwise() + part.col(k);
    }
    sum = next;
  }
  return sum;
}

TEST(Resistance, LInfinityIsThatOfTheMinkowskiSum) {
  Random random(27);
  int closed = 0;
  for (int trial = 0; trial < (long_round() ? 30 : 6); ++trial) {
    const int count = 3 + trial % 2;
    const auto parts = by_contact(random_grasp(random, count), 0.06, 4);
    const auto full = wrench_quality(minkowski_sum(parts));
    const auto fast = linf_resistance(parts);
    ASSERT_TRUE(full && fast);
    // Sums share so many planes that Qhull displaces them by up to 1e-8 before it is content.
    EXPECT_NEAR(std::max(0.0, fast->epsilon), std::max(0.0, full->epsilon), 1e-7);
    if (!fast->force_closure) continue;
    ++closed;
    double support = 0;  // of the sum, without displacement
    for (const MatrixXd& part : parts)
      support += std::max(0.0, (-fast->weakest_direction.transpose() * part).maxCoeff());
    EXPECT_NEAR(fast->epsilon, support, 1e-12);
  }
  EXPECT_GT(closed, 0);
}

TEST(Resistance, LInfinityLiesBetweenL1AndCountTimesL1) {
  // The L1 set is the hull of the contacts' sets: it lies in their sum, and the sum of n of them in
  // n times it, since with force closure all contain, or are drawn out to, the origin.
  Random random(28);
  for (int trial = 0; trial < 20; ++trial) {
    const auto contacts = random_grasp(random, 4 + trial % 4);
    const auto l1 = l1_resistance(contact_wrenches(contacts, 0.06, 6));
    const auto linf = linf_resistance(by_contact(contacts, 0.06, 6));
    ASSERT_TRUE(l1 && linf);
    EXPECT_EQ(l1->force_closure, linf->force_closure);
    if (!l1->force_closure) continue;
    EXPECT_GE(linf->epsilon, l1->epsilon - 1e-9);
    EXPECT_LE(linf->epsilon, static_cast<double>(contacts.size()) * l1->epsilon + 1e-9);
  }
}

}  // namespace
