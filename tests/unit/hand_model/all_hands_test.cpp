// What every hand in models/hands must be; a new folder there is tested with the others.
// Kinematics: frames after each joint against the published table of Denavit-Hartenberg parameters,
//   T_base · Π RotZ(k d_n + offset) · Trans(a, 0, d) · RotX(alpha),
// written out here by itself. A model's link stands at its joint, with z along the axis, so that
// X_link · Trans(a, 0, 0) · RotX(alpha) must be the table's frame. Tolerance 1e-9 m: double
// precision through six transforms of decimetres leaves 1e-16; the rest is for the decimal digits
// of the URDF (1e-12 rad on 0.3 m). Rotations that the tables give in few digits are made rotations
// first. Shapes: links overlap if a point of a grid on the surface of one lies inside the other.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <filesystem>
#include <numbers>

#include "common/analysis/materials.hpp"
#include "common/base/random.hpp"
#include "common/model/hand_model.hpp"
#include "tests/support/hands.hpp"
#include "tests/support/paths/paths.hpp"

namespace {

using namespace prehend;
using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Translation3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double degree = std::numbers::pi / 180;
constexpr double mm = 1e-3;

const std::filesystem::path folder = std::filesystem::path(test::in_sources("common/models/hands"));

// ---- the tables -------------------------------------------------------------------------------

struct Row {  // degrees and mm, as published
  int dof;
  double multiplier, offset, d, a, alpha, lower, upper;
};

struct Finger {
  std::string name;
  Pose base;
  std::vector<Row> rows;
  Vector3d tip;  // mm, in the last frame
};

Pose move(double x, double y, double z) {
  return Pose(Translation3d(x * mm, y * mm, z * mm));
}

Pose turn(const Vector3d& axis, double angle) {
  return Pose(AngleAxisd(angle * degree, axis));
}

const Vector3d X = Vector3d::UnitX(), Y = Vector3d::UnitY(), Z = Vector3d::UnitZ();

/// A rotation given by its columns, to few digits.
Pose columns(const std::array<double, 9>& r) {
  return make_pose(Vector3d::Zero(),
                   *nearest_rotation(Eigen::Map<const Matrix3d>(r.data())));  // column-major
}

std::vector<Finger> barrett() {
  const auto flexion = [](int dof) {
    return std::vector<Row>{{dof, 1, 5, 0, 70, 0, 0, 144}, {dof, 1. / 3, 40, 0, 55, 0, 0, 144}};
  };
  const auto finger = [&](int dof, double alpha) {
    std::vector<Row> rows = flexion(dof);
    rows.insert(rows.begin(), {0, 1, 90, 0, 50, alpha, 0, 180});
    return rows;
  };
  return {{"finger 1", move(25, 0, -1) * turn(Y, 180), finger(1, -90), {0, 0, 0}},
          {"finger 2", move(-25, 0, -1), finger(2, 90), {0, 0, 0}},
          {"finger 3", move(0, -50, -1) * turn(Y, -90) * turn(Z, -90), flexion(3), {0, 0, 0}}};
}

std::vector<Finger> dlr() {
  const auto finger = [](int dof, double lower, double upper) {
    return std::vector<Row>{{dof, 1, 90, 0, 0, -90, -20, 70},
                            {dof + 1, 1, 0, 0, 100.35, 90, lower, upper},
                            {dof + 2, 1, 0, 0, 40, 0, 0, 100},
                            {dof + 2, 1.047619, 0, 0, 0, 90, 0, 104.76}};
  };
  const Vector3d tip(30.4, 0, 0);
  return {
      {"thumb", move(-44.5493, 26.5, 19.85) * turn(X, 180) * turn(Z, 90), finger(0, -30, 30), tip},
      {"index", move(-1.92188, 134.5, 39.0717) * turn(X, 6), finger(3, -30, 10), tip},
      {"middle", move(0, 134.5, 0), finger(6, -30, 30), tip},
      {"ring", move(-2.17275, 134.5, -39.0717) * turn(X, -6), finger(9, -10, 30), tip}};
}

std::vector<Finger> robonaut() {
  const Vector3d tip(18, 0, 0);
  const auto finger = [](int dof) {
    return std::vector<Row>{{dof, 1, 0, 0, 8.0518, 90, -20, 10},
                            {dof + 1, 1, -5.9, 0, 45.72, 0, -10, 85},
                            {dof + 2, 1, 0, 0, 26.67, 0, 0, 85},
                            {dof + 2, 1, 5.9, 0, 0, 0, 0, 85}};
  };
  return {
      {"thumb",
       move(46.183982, -26.490473, 5.890768) *
           columns(
               {.56107, -.820276, -.111118, .145778, .230056, -.962197, .814831, .523661, .248656}),
       {{0, 1, 0, 0, 6.35, 90, -60, 5},
        {1, 1, 8.9, 0, 46.8376, 0, -30, 85},
        {2, 1, 0, 0, 0, 0, 0, 75}},
       {33, 0, 0}},
      {"index",
       move(87.883873, -27.044726, -16.619068) *
           columns({.997205, -.074709, 0, .074425, .993411, -.087156, .006511, .086912, .996195}),
       finger(3), tip},
      {"middle",
       move(87.99289, -2.454097, -16.587521) *
           columns({.999943, -.010702, 0, .010701, .99979, .017452, -.000187, -.017451, .999848}),
       finger(6), tip},
      {"ring",
       move(114.90731, -81.002175, -27.312264) *
           columns({.173619, .025764, .984476, -.818652, -.551893, .158818, .547417, -.833517,
                    -.074727}),
       {{9, .5, 0, 0, 10.287, -20.3269, 0, 30},
        {10, 1, -86.3, -103.9876, 40.6908, 0, 0, 85},
        {11, 1, .71, 0, 26.67, 0, 0, 85},
        {11, 1, 5.95, 0, 0, 0, 0, 85}},
       tip},
      {"little",
       move(157.7787, -146.27967, -33.164526) *
           columns({.229772, .063839, .971148, -.804698, -.548793, .226466, .547417, -.833517,
                    -.074727}),
       {{9, 1, 0, 0, 13.4874, -12.89, 0, 30},
        {12, 1, -82.5, -200.2536, 40.6908, 0, 0, 85},
        {13, 1, .71, 0, 26.67, 0, 0, 85},
        {13, 1, 5.95, 0, 0, 0, 0, 85}},
       tip}};
}

std::vector<Finger> rutgers() {
  const Vector3d tip(25, 0, 0);
  std::vector<Finger> fingers = {
      {"thumb",
       move(59.055, 8.763, 49.53) * turn(Z, 35) * turn(Y, -40) * turn(X, -40),
       {{0, 1, 0, 0, 0, 90, 0, 30}, {1, 1, 0, 0, 39.4335, -90, -30, 30}, {2, 1, 0, 0, 0, 0, 0, 90}},
       tip}};
  int dof = 3;
  for (const auto& [name, z] : std::initializer_list<std::pair<const char*, double>>{
           {"index", 33.02}, {"middle", 11.43}, {"ring", -10.16}, {"little", -29.21}}) {
    fingers.push_back({name,
                       move(91.059, 0, z),
                       {{dof, 1, 0, 0, 0, 90, 0, 90},
                        {dof + 1, 1, 0, 0, 39.4335, -90, -10, 10},
                        {dof + 2, 1, 0, 0, 38.862, 0, 0, 100},
                        {dof + 3, 1, 0, 0, 0, 0, 0, 100}},
                       tip});
    dof += 4;
  }
  return fingers;
}

std::vector<Finger> human() {
  const auto finger = [](int dof, double abduction, double mcp, double pip, double dip) {
    return std::vector<Row>{{dof, 1, 0, 0, 0, 90, -abduction, abduction},
                            {dof + 1, 1, 0, 0, -mcp, 0, -10, 90},
                            {dof + 2, 1, 0, 0, -pip, 0, -10, 90},
                            {dof + 3, 1, 0, 0, -dip, 0, -10, 90}};
  };
  const Vector3d tip(0, 0, 0);
  return {
      {"index", move(-140.06, 11.20, 36.42) * turn(X, -90), finger(0, 20, 43.19, 29.56, 25.35),
       tip},
      {"middle", move(-145.66, 11.20, 8.40) * turn(X, -90), finger(4, 10, 46.20, 30.99, 29.20),
       tip},
      {"ring", move(-145.66, 5.60, -19.61) * turn(X, -90), finger(8, 20, 39.12, 28.31, 24.48), tip},
      {"little", move(-134.46, -8.40, -42.02) * turn(X, -90), finger(12, 30, 29.91, 21.10, 23.16),
       tip},
      {"thumb",
       move(-50.6241, -11.5082, 18.9317) *
           columns({-.1486, -.9003, .4089, .2665, .3618, .8933, -.9522, .2418, .1862}),
       {{16, 1, 0, 0, 0, 90, -10, 70},
        {17, 1, 49.5, 0, 52.1193, 44, -50, 25},
        {18, 1, 5, 0, 40.7638, 0, 0, 90},
        {19, 1, 85, 0, 0, 90, 0, 100}},
       {0, 0, 28}}};
}

struct Published {
  std::vector<Finger> fingers;
  std::size_t dofs, joints;
};

const std::map<std::string, Published> tables = {
    {"barrett", {barrett(), 4, 8}},     {"dlr", {dlr(), 12, 16}},
    {"robonaut", {robonaut(), 14, 19}}, {"rutgers", {rutgers(), 19, 19}},
    {"human", {human(), 20, 20}},
};

// ---- helpers ----------------------------------------------------------------------------------

VectorXd random_dof(const model::HandModel& hand, Random& random) {
  VectorXd dof(static_cast<Eigen::Index>(hand.dofs().size()));
  for (Eigen::Index i = 0; i < dof.size(); ++i) {
    const auto& limits = hand.dofs()[static_cast<std::size_t>(i)];
    dof[i] = random.uniform(limits.lower, limits.upper);
  }
  return dof;
}

/// Joints from the palm to a fingertip.
std::vector<int> chain(const model::HandModel& hand, const model::HandFingertip& tip) {
  std::vector<int> joints;
  for (int joint = hand.links()[static_cast<std::size_t>(tip.link)].joint; joint >= 0;) {
    joints.insert(joints.begin(), joint);
    const int parent = hand.joints()[static_cast<std::size_t>(joint)].parent;
    joint = hand.links()[static_cast<std::size_t>(parent)].joint;
  }
  return joints;
}

/// Points on the surface of a shape, at most about 3 mm apart.
std::vector<Vector3d> surface(const model::Shape& shape) {
  std::vector<Vector3d> points;
  const Vector3d half = model::half_extents(shape);
  const auto steps = [](double length) { return std::max(2, static_cast<int>(length / 0.003)); };
  const int round = steps(2 * std::numbers::pi * half.x());
  if (shape.kind == model::ShapeKind::box) {
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      const int nu = steps(2 * half[u]), nv = steps(2 * half[v]);
      for (int i = 0; i <= nu; ++i)
        for (int j = 0; j <= nv; ++j)
          for (const double side : {-1.0, 1.0}) {
            Vector3d p;
            p[axis] = side * half[axis];
            p[u] = half[u] * (2.0 * i / nu - 1);
            p[v] = half[v] * (2.0 * j / nv - 1);
            points.push_back(p);
          }
    }
    return points;
  }
  for (int i = 0; i < round; ++i) {
    const Vector3d out = AngleAxisd(2 * std::numbers::pi * i / round, Z) * X;
    if (shape.kind == model::ShapeKind::sphere) {
      for (int j = 0; j <= round / 2; ++j)
        points.push_back(half.x() * (AngleAxisd(2 * std::numbers::pi * i / round, Z) *
                                     AngleAxisd(2 * std::numbers::pi * j / round, Y) * Z));
    } else {
      const int up = steps(2 * half.z()), in = steps(half.x());
      for (int j = 0; j <= up; ++j)
        points.push_back(half.x() * out + half.z() * (2.0 * j / up - 1) * Z);
      for (int j = 0; j <= in; ++j)
        for (const double side : {-1.0, 1.0})
          points.push_back(half.x() * j / in * out + side * half.z() * Z);
    }
  }
  return points;
}

/// Distance of a point from a link's shapes, negative inside.
double distance(const model::HandLink& link, const Pose& X_BL, const Vector3d& p_B) {
  double least = 1;
  for (const auto& part : link.collision)
    least = std::min(least, model::signed_distance(part.shape, (X_BL * part.X_LS).inverse() * p_B));
  return least;
}

/// Least distance of any surface point of one link from another.
double distance(const model::HandLink& a, const Pose& X_BA, const model::HandLink& b,
                const Pose& X_BB) {
  double least = 1;
  for (const auto& part : a.collision)
    for (const Vector3d& p : surface(part.shape))
      least = std::min(least, distance(b, X_BB, X_BA * part.X_LS * p));
  return least;
}

/// Links that meet in a joint, or in two across a link without a shape, may overlap there.
bool neighbours(const model::HandModel& hand, int a, int b) {
  const auto parent = [&](int link) {
    const int joint = hand.links()[static_cast<std::size_t>(link)].joint;
    return joint < 0 ? -1 : hand.joints()[static_cast<std::size_t>(joint)].parent;
  };
  const auto meets = [&](int child, int other) {
    for (int at = parent(child); at >= 0; at = parent(at)) {
      if (at == other) return true;
      if (!hand.links()[static_cast<std::size_t>(at)].collision.empty()) return false;
    }
    return false;
  };
  return meets(a, b) || meets(b, a);
}

/// The open hand with every closing DoF moved by a share of the way to its limit.
VectorXd closed(const model::HandModel& hand, double share) {
  VectorXd dof = hand.postures().at("open");
  for (Eigen::Index i = 0; i < dof.size(); ++i) {
    const auto& limits = hand.dofs()[static_cast<std::size_t>(i)];
    if (limits.closing != 0)
      dof[i] += share * ((limits.closing > 0 ? limits.upper : limits.lower) - dof[i]);
  }
  return dof;
}

/// Mean distance between two fingertips.
double span(const std::vector<Vector3d>& tips) {
  double sum = 0;
  for (const Vector3d& a : tips)
    for (const Vector3d& b : tips) sum += (a - b).norm();
  return sum / static_cast<double>(tips.size() * (tips.size() - 1));
}

// ---- the properties ---------------------------------------------------------------------------

class AllHands : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    auto loaded = model::HandModel::load(folder / GetParam());
    ASSERT_TRUE(loaded) << loaded.error().message();
    hand = std::move(*loaded);
  }

  model::HandModel hand;
};

/// Those of which a table is published.
class PublishedHands : public AllHands {
 protected:
  const Published& table() const { return tables.at(GetParam()); }
};

TEST_P(PublishedHands, EqualTheirTableEverywhere) {
  ASSERT_EQ(hand.fingertips().size(), table().fingers.size());
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const VectorXd d = random_dof(hand, random);
    const std::vector<Pose> X_BL = hand.link_poses(hand.joint_angles(d));
    const std::vector<Vector3d> tips = hand.fingertip_positions(d);
    for (std::size_t f = 0; f < tips.size(); ++f) {
      const Finger& finger = table().fingers[f];
      ASSERT_EQ(hand.fingertips()[f].name, finger.name);
      const std::vector<int> joints = chain(hand, hand.fingertips()[f]);
      ASSERT_EQ(joints.size(), finger.rows.size());
      Pose expected = finger.base;
      for (std::size_t i = 0; i < joints.size(); ++i) {
        const Row& row = finger.rows[i];
        expected = expected * turn(Z, row.multiplier * d[row.dof] / degree + row.offset) *
                   move(row.a, 0, row.d) * turn(X, row.alpha);
        const int child = hand.joints()[static_cast<std::size_t>(joints[i])].child;
        const Pose actual =
            X_BL[static_cast<std::size_t>(child)] * move(row.a, 0, 0) * turn(X, row.alpha);
        ASSERT_LT((expected.matrix() - actual.matrix()).cwiseAbs().maxCoeff(), 1e-9)
            << finger.name << ", joint " << i << " at " << d.transpose();
      }
      ASSERT_LT((tips[f] - expected * Vector3d(finger.tip * mm)).norm(), 1e-9) << finger.name;
    }
  }
}

// A joint that is coupled needs no more than what the coupling gives it.
TEST_P(PublishedHands, HaveTheLimitsAndCountsOfTheirTable) {
  EXPECT_EQ(hand.dofs().size(), table().dofs);
  EXPECT_EQ(hand.joints().size(), table().joints);
  for (std::size_t f = 0; f < table().fingers.size(); ++f) {
    const std::vector<int> joints = chain(hand, hand.fingertips()[f]);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const Row& row = table().fingers[f].rows[i];
      const auto& joint = hand.joints()[static_cast<std::size_t>(joints[i])];
      EXPECT_EQ(joint.dof, row.dof) << joint.name;
      EXPECT_NEAR(joint.multiplier, row.multiplier, 1e-12) << joint.name;
      EXPECT_EQ(joint.offset, 0) << joint.name;
      const auto& dof = hand.dofs()[static_cast<std::size_t>(joint.dof)];
      const double lower = std::max(row.lower * degree, row.multiplier * dof.lower);
      const double upper = std::min(row.upper * degree, row.multiplier * dof.upper);
      EXPECT_NEAR(joint.lower, lower, 1e-9) << joint.name;
      EXPECT_NEAR(joint.upper, upper, 1e-9) << joint.name;
    }
  }
}

TEST_P(AllHands, CouplesWithinTheLimitsOfEveryJoint) {
  for (const auto& joint : hand.joints()) {
    const auto& dof = hand.dofs()[static_cast<std::size_t>(joint.dof)];
    for (const double value : {dof.lower, dof.upper}) {
      const double q = joint.multiplier * value + joint.offset;
      EXPECT_GE(q, joint.lower - 1e-3) << joint.name;
      EXPECT_LE(q, joint.upper + 1e-3) << joint.name;
    }
  }
  for (const auto& dof : hand.dofs())
    EXPECT_EQ(dof.kind, hand.joints()[static_cast<std::size_t>(dof.joint)].kind) << dof.name;
}

TEST_P(AllHands, StandsOpenWithoutTouchingItself) {
  const std::vector<Pose> X_BL = hand.link_poses(hand.joint_angles(hand.postures().at("open")));
  for (std::size_t i = 0; i < hand.links().size(); ++i)
    for (std::size_t j = 0; j < hand.links().size(); ++j)
      if (i != j && !neighbours(hand, static_cast<int>(i), static_cast<int>(j))) {
        EXPECT_GT(distance(hand.links()[i], X_BL[i], hand.links()[j], X_BL[j]), 0)
            << hand.links()[i].name << " and " << hand.links()[j].name;
      }
}

TEST_P(AllHands, ClosesItsFingertipsOnEachOther) {
  const auto open = hand.fingertip_positions(hand.postures().at("open"));
  const auto half = hand.fingertip_positions(closed(hand, 0.5));
  EXPECT_LT(span(half), span(open) - 0.005);
}

// y of the grasp frame is the way the fingers close, z is out of the palm.
TEST_P(AllHands, FacesWhatItGrasps) {
  const Pose X_GB = hand.X_BG().inverse();
  double palm = -1;
  for (const auto& part : hand.links()[0].collision)
    for (const Vector3d& p : surface(part.shape)) palm = std::max(palm, (X_GB * part.X_LS * p).z());
  EXPECT_LT(palm, 0) << "the palm reaches beyond the grasp frame";

  const auto width = [&](const std::vector<Vector3d>& tips) {
    double least = 1, most = -1, forward = 0;
    for (const Vector3d& tip : tips) {
      const Vector3d p_G = X_GB * tip;
      least = std::min(least, p_G.y());
      most = std::max(most, p_G.y());
      forward += (p_G.z() - palm) / static_cast<double>(tips.size());
    }
    return std::pair(most - least, forward);
  };
  const auto open = width(hand.fingertip_positions(hand.postures().at("open")));
  const auto half = width(hand.fingertip_positions(closed(hand, 0.5)));
  EXPECT_LT(half.first, open.first) << "the fingers do not close along y";
  EXPECT_GT(half.second, 0) << "the closing fingers are not in front of the palm";
  EXPECT_GT(half.second, open.second - 0.001) << "the fingers close away from the grasp frame";
}

// DLR's fingers, straight, reached 11 mm deeper than its clearance said, and met the table before
// the object; Robonaut's, spread beside a can, 24 mm further than its half width.
TEST_P(AllHands, StandsOpenAboveTheTableFromAboveAndFromTheSide) {
  const Pose X_GB = hand.X_BG().inverse();
  const auto X_BL = hand.link_poses(hand.joint_angles(hand.postures().at("open")));
  double depth = 0, width = 0;
  for (std::size_t i = 0; i < hand.links().size(); ++i)
    for (const auto& part : hand.links()[i].collision)
      for (const Vector3d& p : surface(part.shape)) {
        const Vector3d p_G = X_GB * X_BL[i] * part.X_LS * p;
        depth = std::max(depth, p_G.z());
        width = std::max(width, std::abs(p_G.x()));
      }
  EXPECT_LT(depth, hand.reach().clearance);
  EXPECT_LT(width, hand.reach().half_width);
}

TEST_P(AllHands, HasFingertipsOnItsSurface) {
  for (const auto& tip : hand.fingertips()) {
    const auto& link = hand.links()[static_cast<std::size_t>(tip.link)];
    EXPECT_NEAR(distance(link, Pose::Identity(), tip.p_LT), 0, 0.002) << tip.name;
    EXPECT_EQ(hand.fingertips()[static_cast<std::size_t>(link.finger)].name, tip.name);
  }
  EXPECT_EQ(hand.links()[0].finger, -1);
  EXPECT_FALSE(hand.links()[0].collision.empty()) << "the palm is not there";
}

// Principal moments of a body obey the triangle inequality: Ixx + Iyy - Izz = 2 ∫ z² dm. The four
// digits of the files leave 1e-3 of it.
TEST_P(AllHands, HasMassesThatExist) {
  double total = 0;
  for (const auto& link : hand.links()) {
    total += link.mass;
    EXPECT_GE(link.mass, 0.005) << link.name;
    const Vector3d moments =
        Eigen::SelfAdjointEigenSolver<Matrix3d>(link.inertia_L).eigenvalues();  // ascending
    EXPECT_GT(moments[0], 0) << link.name;
    EXPECT_GE(moments[0] + moments[1], moments[2] * 0.999) << link.name;
    // No point of a link that weighs anything is further than 0.15 m from its centre.
    EXPECT_LT(moments[2], link.mass * 0.15 * 0.15) << link.name;
    EXPECT_TRUE(analysis::material_from_string(link.material)) << link.material;
    if (!link.collision.empty()) {
      EXPECT_LT(distance(link, Pose::Identity(), link.com_L), 0.005) << link.name;
    }
  }
  EXPECT_GT(total, 0.3);
  EXPECT_LT(total, 5);
}

INSTANTIATE_TEST_SUITE_P(Models, AllHands, testing::ValuesIn(test::hand_names()),
                         [](const auto& hand) { return hand.param; });

std::vector<std::string> published() {
  std::vector<std::string> names;
  for (const auto& [name, table] : tables) names.push_back(name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(Models, PublishedHands, testing::ValuesIn(published()),
                         [](const auto& hand) { return hand.param; });

TEST(AllHands, EveryTableHasItsHand) {
  const std::vector<std::string> found = test::hand_names();
  for (const auto& [name, table] : tables)
    EXPECT_TRUE(std::find(found.begin(), found.end(), name) != found.end()) << name;
}

// 0 to 85 mm between pads of 20 x 40 mm, which stay face to face.
TEST(ParallelJaw, OpensSymmetrically) {
  const auto hand = model::HandModel::load(folder / "parallel_jaw");
  ASSERT_TRUE(hand) << hand.error().message();
  ASSERT_EQ(hand->dofs().size(), 1u);
  ASSERT_EQ(hand->joints().size(), 2u);
  EXPECT_EQ(hand->dofs()[0].kind, model::JointKind::prismatic);
  EXPECT_NEAR(hand->dofs()[0].lower, 0, 1e-12);
  EXPECT_NEAR(2 * hand->dofs()[0].upper, 0.085, 1e-12);
  for (const double way : {0.0, 0.01, 0.0425}) {
    const auto tips = hand->fingertip_positions(VectorXd::Constant(1, way));
    ASSERT_EQ(tips.size(), 2u);
    EXPECT_LT((tips[0] - tips[1] - 2 * way * Y).norm(), 1e-12);
    EXPECT_LT((tips[0] + tips[1]).cwiseProduct(Vector3d(1, 1, 0)).norm(), 1e-12);
  }
}

}  // namespace
