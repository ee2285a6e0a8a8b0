// ε is the radius of the largest ball about the origin in the hull of the wrenches. Where the hull
// is a known body, ε and volume are known exactly; there the tolerance is 1e-9, what is left of
// double precision after Qhull has joggled coplanar points by about 1e-11. GraspIt!'s own figures
// have nine digits in their wrenches: 1e-6 for ε, 5e-4 for its volume (it trims facets).
#include "common/analysis/wrench_space.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>

#include "common/analysis/convex_hull.hpp"
#include "common/base/random.hpp"
#include "tests/support/shared_data.hpp"

namespace {

using namespace prehend;
using namespace prehend::analysis;
using Eigen::MatrixXd;
using Eigen::Vector3d;

TEST(WrenchSpace, Diamond) {
  MatrixXd w(2, 4);
  w << 1, -1, 0, 0, 0, 0, 1, -1;
  const auto q = wrench_quality(w);
  ASSERT_TRUE(q);
  EXPECT_NEAR(q->epsilon, 1 / std::numbers::sqrt2, 1e-9);
  EXPECT_NEAR(q->volume, 2, 1e-9);
  EXPECT_TRUE(q->force_closure);
}

TEST(WrenchSpace, CrossPolytopeOfSixDimensions) {
  MatrixXd w(6, 12);
  w << MatrixXd::Identity(6, 6), -MatrixXd::Identity(6, 6);
  const auto q = wrench_quality(w);
  ASSERT_TRUE(q);
  EXPECT_NEAR(q->epsilon, 1 / std::sqrt(6.0), 1e-9);
  EXPECT_NEAR(q->volume, 64.0 / 720, 1e-9);
}

TEST(WrenchSpace, PlanarAntipodalDisk) {
  // Two opposite contacts on a unit disk, (fx, fy, τ): edges (∓1, ±μ) with torques ±μ.
  for (const double mu : {0.2, 0.5, 1.0}) {
    MatrixXd w(3, 4);
    w.col(0) << 1, mu, -mu;
    w.col(1) << 1, -mu, mu;
    w.col(2) << -1, mu, mu;
    w.col(3) << -1, -mu, -mu;
    const auto q = wrench_quality(w);
    ASSERT_TRUE(q);
    EXPECT_NEAR(q->epsilon, mu / std::sqrt(mu * mu + 2), 1e-9);
    EXPECT_NEAR(q->volume, 8 * mu * mu / 3, 1e-9);
    const auto fast = l1_resistance(w);
    ASSERT_TRUE(fast);
    EXPECT_NEAR(fast->epsilon, mu / std::sqrt(mu * mu + 2), 1e-9);
  }
}

TEST(WrenchSpace, WeakestDirectionTouchesTheHullWhereTheBallDoes) {
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    MatrixXd w(6, 30);
    for (Eigen::Index i = 0; i < w.size(); ++i) w(i) = random.normal();
    const auto q = wrench_quality(w);
    ASSERT_TRUE(q);
    if (!q->force_closure) continue;
    EXPECT_NEAR(q->weakest_direction.norm(), 1, 1e-9);
    // Against a load along d the grasp can push at most ε: the hull's support along -d.
    EXPECT_NEAR((-q->weakest_direction.transpose() * w).maxCoeff(), q->epsilon, 1e-9);
    // No other direction is weaker.
    for (int k = 0; k < 200; ++k) {
      Eigen::VectorXd d(6);
      for (Eigen::Index i = 0; i < 6; ++i) d[i] = random.normal();
      EXPECT_GE((d.normalized().transpose() * w).maxCoeff(), q->epsilon - 1e-9);
    }
  }
}

TEST(WrenchSpace, TurningAllWrenchesChangesNothing) {
  Random random(4);
  MatrixXd w(6, 24);
  for (Eigen::Index i = 0; i < w.size(); ++i) w(i) = random.normal();
  MatrixXd square(6, 6);
  for (Eigen::Index i = 0; i < square.size(); ++i) square(i) = random.normal();
  const MatrixXd Q = Eigen::HouseholderQR<MatrixXd>(square).householderQ();
  const auto before = wrench_quality(w), after = wrench_quality(Q * w);
  ASSERT_TRUE(before && after);
  EXPECT_NEAR(before->epsilon, after->epsilon, 1e-9);
  EXPECT_NEAR(before->volume, after->volume, 1e-8 * before->volume);
}

std::vector<Contact> tripod(double friction) {
  std::vector<Contact> contacts;
  for (int i = 0; i < 3; ++i) {
    const double a = 2 * std::numbers::pi * i / 3;
    const Vector3d out(std::cos(a), std::sin(a), 0);
    contacts.push_back({"f", 0.02 * out, -out, friction, 1, 0});
  }
  return contacts;
}

TEST(WrenchSpace, MoreFrictionIsNeverWorse) {
  double last = -1;
  for (const double mu : {0.1, 0.3, 0.6, 1.0, 2.0}) {
    const auto q = grasp_quality(tripod(mu), {model::ShapeKind::sphere, Vector3d::Constant(0.02)});
    ASSERT_TRUE(q);
    EXPECT_GT(q->epsilon, last);
    last = q->epsilon;
  }
}

TEST(WrenchSpace, WithoutForceClosureEpsilonIsMinusOne) {
  auto contacts = tripod(0.5);
  contacts.pop_back();
  contacts[1].normal_O = contacts[0].normal_O;  // both push the same way
  const auto one_sided = wrench_quality(contact_wrenches(contacts, 0.02));
  ASSERT_TRUE(one_sided);
  EXPECT_EQ(one_sided->epsilon, -1);
  EXPECT_FALSE(one_sided->force_closure);
  EXPECT_EQ(one_sided->weakest_direction, Eigen::VectorXd::Zero(6));
  // Two point contacts cannot resist torque about the line between them: a flat hull.
  const auto pair = wrench_quality(contact_wrenches(
      {{"a", {0.02, 0, 0}, {-1, 0, 0}, 1, 1, 0}, {"b", {-0.02, 0, 0}, {1, 0, 0}, 1, 1, 0}}, 0.02));
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->epsilon, -1);
  EXPECT_EQ(pair->volume, 0);
  const auto none = wrench_quality(contact_wrenches({}, 0.02));
  ASSERT_TRUE(none);
  EXPECT_EQ(none->epsilon, -1);
}

TEST(WrenchSpace, RefusesWhatIsNotFinite) {
  MatrixXd w = MatrixXd::Random(6, 20);
  w(3, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(wrench_quality(w));
  w(3, 3) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(wrench_quality(w));
  EXPECT_FALSE(grasp_quality(tripod(1), {}));
  EXPECT_EQ(grasp_quality(tripod(1), model::Shape{}).error().what, "the object has no valid shape");
  EXPECT_EQ(convex_hull(MatrixXd::Random(3, 2)).error().what, "convex hull failed");
  EXPECT_EQ(wrench_quality(MatrixXd::Ones(1, 3)).error().what,
            "wrenches need at least two dimensions");
}

TEST(WrenchSpace, AgreesWithGraspIt) {
  const std::filesystem::path folder = shared_data() / "graspit_contacts";
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << folder << " is not there";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path().filename());
    std::ifstream file(entry.path());
    std::string line;
    double epsilon = 0, volume = 0, scale = 0;
    std::vector<Eigen::Matrix<double, 6, 1>> lines;
    std::vector<Contact> contacts;
    while (std::getline(file, line)) {
      double v[7];
      int number = 0;
      if (std::sscanf(line.c_str(), "EPSILON %lf VOLUME %lf", v, v + 1) == 2) {
        epsilon = v[0];
        volume = v[1];
      } else if (std::sscanf(line.c_str(), "CONTACTS %d maxRadius %lf", &number, v) == 2) {
        scale = v[0] * 1e-3;
      } else if (std::sscanf(line.c_str(), "C %d pos %lf %lf %lf n %lf %lf %lf cof %lf", &number, v,
                             v + 1, v + 2, v + 3, v + 4, v + 5, v + 6) == 8) {
        contacts.push_back(
            {"", Vector3d(v[0], v[1], v[2]) * 1e-3, Vector3d(v[3], v[4], v[5]), v[6], 1, 0});
      } else if (std::sscanf(line.c_str(), "W %lf %lf %lf %lf %lf %lf", v, v + 1, v + 2, v + 3,
                             v + 4, v + 5) == 6) {
        lines.emplace_back(v);
        Vector3d& tangent = contacts.back().tangent_O;  // the first edge gives it
        if (tangent.isZero()) tangent = Vector3d(v[0], v[1], v[2]) - contacts.back().normal_O;
      }
    }
    ASSERT_GE(lines.size(), 16u);
    MatrixXd w(6, static_cast<Eigen::Index>(lines.size()));
    for (std::size_t i = 0; i < lines.size(); ++i) w.col(static_cast<Eigen::Index>(i)) = lines[i];
    const auto from_lines = wrench_quality(w);
    ASSERT_TRUE(from_lines);
    EXPECT_NEAR(from_lines->epsilon, epsilon, 1e-6 * std::abs(epsilon) + 1e-8);
    EXPECT_NEAR(from_lines->volume, volume, 5e-4 * volume);
    const auto fast = l1_resistance(w);
    ASSERT_TRUE(fast);
    EXPECT_NEAR(fast->epsilon, epsilon, 1e-6 * std::abs(epsilon) + 1e-8);
    const auto from_contacts = wrench_quality(contact_wrenches(contacts, scale));
    ASSERT_TRUE(from_contacts);
    // Positions and normals have four or five digits.
    EXPECT_NEAR(from_contacts->epsilon, epsilon, 2e-4 * std::abs(epsilon));
    ++files;
  }
  EXPECT_GE(files, 3);
}

}  // namespace
