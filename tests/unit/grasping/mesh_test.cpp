// Meshes as bodies. Mass properties of a box and of a tetrahedron are known in closed form and come
// out to rounding (1e-12), also far from the file's origin and inside out; STL and OBJ hold decimal
// text of 9 digits here (1e-7). Parts of an L and a U made of boxes are exact: they are found to 1
// %.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>

#include "common/grasping/mesh_body.hpp"
#include "common/model/bounding_shape.hpp"
#include "tests/support/hands.hpp"

namespace {

using namespace prehend;
using namespace prehend::grasping;
using Eigen::Vector3d;
using model::Mesh;

/// A prism: the polygon (counterclockwise, in x and y) from z = 0 to `height`, its caps cut into
/// the given triangles.
Mesh prism(const std::vector<Eigen::Vector2d>& outline, const std::vector<Eigen::Vector3i>& cap,
           double height) {
  Mesh mesh;
  const int n = static_cast<int>(outline.size());
  for (const double z : {0.0, height})
    for (const auto& p : outline) mesh.vertices.emplace_back(p.x(), p.y(), z);
  for (const Eigen::Vector3i& t : cap) {
    mesh.triangles.emplace_back(t[0], t[2], t[1]);
    mesh.triangles.emplace_back(t[0] + n, t[1] + n, t[2] + n);
  }
  for (int i = 0; i < n; ++i) {
    const int k = (i + 1) % n;
    mesh.triangles.emplace_back(i, k, k + n);
    mesh.triangles.emplace_back(i, k + n, i + n);
  }
  return mesh;
}

Mesh box(double x, double y, double z) {
  return prism({{0, 0}, {x, 0}, {x, y}, {0, y}}, {{0, 1, 2}, {0, 2, 3}}, z);
}

/// An L of two bars of 20 mm, 80 mm long each way, 30 mm high.
Mesh angle() {
  return prism({{0, 0}, {0.08, 0}, {0.08, 0.02}, {0.02, 0.02}, {0.02, 0.08}, {0, 0.08}},
               {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}, 0.03);
}

class MeshFile : public testing::Test {
 protected:
  MeshFile() { std::filesystem::create_directories(folder_); }
  ~MeshFile() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  std::filesystem::path obj(const Mesh& mesh) const {
    std::ostringstream text;
    text.precision(9);
    for (const Vector3d& v : mesh.vertices) text << "v " << v.transpose() << "\n";
    for (const Eigen::Vector3i& t : mesh.triangles)
      text << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
    return write("mesh.obj", text.str());
  }

  std::filesystem::path stl(const Mesh& mesh) const {
    std::ostringstream text;
    text.precision(9);
    text << "solid mesh\n";
    for (const Eigen::Vector3i& t : mesh.triangles) {
      text << "facet normal 0 0 0\nouter loop\n";
      for (int k = 0; k < 3; ++k)
        text << "vertex " << mesh.vertices[static_cast<std::size_t>(t[k])].transpose() << "\n";
      text << "endloop\nendfacet\n";
    }
    return write("mesh.stl", text.str() + "endsolid mesh\n");
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("prehend_mesh_" + std::to_string(::getpid()));
};

TEST(Measure, ABoxIsWhatTheTextbookSays) {
  const Vector3d size(0.03, 0.05, 0.11), far(2, -3, 1);
  const auto solid = model::measure(model::moved(box(size.x(), size.y(), size.z()), far));
  ASSERT_TRUE(solid) << solid.error().message();
  EXPECT_NEAR(solid->volume, size.prod(), 1e-12 * 1e-2);
  EXPECT_LT((solid->centre - far - 0.5 * size).norm(), 1e-12);
  const Vector3d squares = size.cwiseAbs2();
  const Vector3d expected((squares.y() + squares.z()) / 12, (squares.z() + squares.x()) / 12,
                          (squares.x() + squares.y()) / 12);
  EXPECT_LT((solid->inertia - Eigen::Matrix3d(expected.asDiagonal())).norm(), 1e-12);
}

TEST(Measure, ATetrahedronHasItsCentreAtAQuarter) {
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                  {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  const auto solid = model::measure(mesh);
  ASSERT_TRUE(solid);
  EXPECT_NEAR(solid->volume, 1.0 / 6, 1e-12);
  EXPECT_LT((solid->centre - Vector3d::Constant(0.25)).norm(), 1e-12);
  // ∫(y²+z²)/V about the centre: 2·(1/10 - 1/16) = 3/40; products: 1/20 - 1/16 = -1/80.
  EXPECT_NEAR(solid->inertia(0, 0), 3.0 / 40, 1e-12);
  EXPECT_NEAR(solid->inertia(0, 1), 1.0 / 80, 1e-12);
}

TEST(Measure, RefusesWhatIsOpen) {
  Mesh open = box(1, 1, 1);
  open.triangles.pop_back();
  EXPECT_FALSE(model::measure(open));
  const Mesh flat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  EXPECT_EQ(model::measure(flat).error().what, "mesh encloses no volume");
}

TEST_F(MeshFile, StlAndObjGiveTheSameSolid) {
  const auto from_obj = model::load_mesh(obj(angle()));
  const auto from_stl = model::load_mesh(stl(angle()));
  ASSERT_TRUE(from_obj) << from_obj.error().message();
  ASSERT_TRUE(from_stl) << from_stl.error().message();
  EXPECT_EQ(from_stl->vertices.size(), angle().vertices.size());  // merged again
  const auto a = model::measure(*from_obj), b = model::measure(*from_stl),
             exact = model::measure(angle());
  for (const auto& solid : {a, b}) {
    EXPECT_NEAR(solid->volume / exact->volume, 1, 1e-6);
    EXPECT_LT((solid->centre - exact->centre).norm(), 1e-7);
  }
}

TEST_F(MeshFile, AnInsideOutMeshIsTurned) {
  Mesh inside_out = box(0.1, 0.1, 0.1);
  for (auto& t : inside_out.triangles) std::swap(t[0], t[1]);
  const auto mesh = model::load_mesh(obj(inside_out), 0.5);
  ASSERT_TRUE(mesh) << mesh.error().message();
  EXPECT_NEAR(model::measure(*mesh)->volume, 1e-3 / 8, 1e-9);
}

TEST_F(MeshFile, RefusesNonsenseWithAReason) {
  Mesh open = box(0.1, 0.1, 0.1);
  open.triangles.pop_back();
  for (const auto& file : {write("a.obj", ""), write("b.stl", "garbage"), write("c.ply", "ply"),
                           write("d.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"),
                           write("e.obj", "f 1 2 3\n"), obj(open), folder_ / "absent.stl"}) {
    const auto mesh = model::load_mesh(file);
    ASSERT_FALSE(mesh) << file;
    EXPECT_FALSE(mesh.error().what.empty());
  }
  std::string many = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i <= 200'000; ++i) many += "f 1 2 3\n";
  EXPECT_EQ(model::load_mesh(write("f.obj", many)).error().what, "has more than 200,000 triangles");
  const auto good = obj(box(0.1, 0.1, 0.1));
  for (const double scale : {0.0, -1.0, 1000.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_FALSE(model::load_mesh(good, scale)) << scale;
}

TEST(ConvexPartsOf, AConvexMeshIsItsHull) {
  const auto parts = convex_parts(box(0.03, 0.05, 0.11));
  ASSERT_TRUE(parts);
  EXPECT_EQ(parts->parts.size(), 1u);
  EXPECT_NEAR(parts->concavity, 0, 1e-9);
  EXPECT_EQ(parts->parts.front().size(), 8u);
}

TEST(ConvexPartsOf, AreAtLeastOneAndMayExceedTheSolid) {
  for (const PartsOptions& wrong : {PartsOptions{.max_excess = 0}, PartsOptions{.max_parts = 0}}) {
    const auto parts = convex_parts(box(1, 1, 1), wrong);
    ASSERT_FALSE(parts);
    EXPECT_EQ(parts.error().what, "parts must be at least 1, their excess positive");
  }
}

TEST(ConvexPartsOf, AnAngleIsTwoBars) {
  const auto parts = convex_parts(angle());
  ASSERT_TRUE(parts);
  // Hull: 0.08² - 0.06²/2 = 46 cm², the angle itself 28 cm².
  EXPECT_NEAR(parts->concavity, 46.0 / 28 - 1, 1e-6);
  EXPECT_EQ(parts->parts.size(), 2u);
  EXPECT_LT(parts->excess, 0.01);
}

TEST(ConvexPartsOf, MorePartsComeNearerToACurvedHollow) {
  // A half pipe of 16 segments: outer radius 50 mm, inner 40 mm.
  std::vector<Eigen::Vector2d> outline;
  std::vector<Eigen::Vector3i> cap;
  const int n = 16;
  for (int i = 0; i <= n; ++i)
    outline.emplace_back(0.05 * std::cos(M_PI * i / n), 0.05 * std::sin(M_PI * i / n));
  for (int i = n; i >= 0; --i)
    outline.emplace_back(0.04 * std::cos(M_PI * i / n), 0.04 * std::sin(M_PI * i / n));
  for (int i = 0; i < n; ++i) {
    const int inner = 2 * n + 1 - i;
    cap.emplace_back(i, i + 1, inner);
    cap.emplace_back(i + 1, inner - 1, inner);
  }
  const Mesh mesh = prism(outline, cap, 0.06);
  const auto coarse = convex_parts(mesh, {.max_parts = 4});
  const auto fine = convex_parts(mesh, {.max_parts = 16});
  ASSERT_TRUE(coarse && fine);
  EXPECT_GT(coarse->concavity, 1.5);
  EXPECT_LT(fine->excess, coarse->excess);
  EXPECT_LT(fine->excess, 0.1);
  EXPECT_LE(fine->parts.size(), 16u);
}

const model::HandModel& barrett() {
  return test::hand("barrett");
}

/// A body of 200 g with this mesh.
Body meshed(const Mesh& mesh, const std::string& material) {
  const auto solid = solid_of(mesh);
  EXPECT_TRUE(solid) << solid.error().message();
  return {.name = "mesh",
          .shape = {model::ShapeKind::box, model::bounds(mesh).sizes()},
          .mass = 0.2,
          .material = material,
          .mesh = *solid};
}

TEST_F(MeshFile, ABodyRestsOnTheTableWithItsHollowFree) {
  const Body body = meshed(angle(), "wood");
  EXPECT_GT(body.mesh->parts.parts.size(), 1u);
  auto world =
      std::move(*World::create(barrett(), make_pose(Vector3d(0, 0, 1)), Eigen::VectorXd::Zero(4)));
  // Lying flat; its centre of mass is half its height above the table.
  ASSERT_TRUE(world->add_body(body, make_pose(Vector3d(0, 0, 0.0155))));
  // A ball that lies in the hollow: a hull would push it out.
  const Vector3d hollow = Vector3d(0.045, 0.045, 0.01) - Vector3d(0.04, 0.04, 0.015);
  const Body ball{"ball", {model::ShapeKind::sphere, Vector3d::Constant(0.01)}, 0.05, "wood", {}};
  ASSERT_TRUE(world->add_body(ball, make_pose(Vector3d(hollow.x(), hollow.y(), 0.0105))));
  for (int i = 0; i < 1000; ++i) world->step();
  const BodyMotion motion = world->body_motion(0);
  EXPECT_GT(body.mesh->p_OC.norm(), 0.01);                    // which is not the middle of its box
  EXPECT_NEAR(motion.X_WO.translation().z(), 0.015, 1.5e-3);  // the margin is 0.5 mm
  EXPECT_LT(motion.X_WO.translation().head<2>().norm(), 1e-3);
  EXPECT_LT(angle_between(motion.X_WO.linear(), Eigen::Matrix3d::Identity()), 0.02);
  EXPECT_LT((world->body_motion(1).X_WO.translation().head<2>() - hollow.head<2>()).norm(), 2e-3);
}

TEST_F(MeshFile, ABoxMeshMovesAsTheBoxDoes) {
  // Spinning freely about all axes: the principal axes and moments must be the same.
  const Vector3d size(0.04, 0.07, 0.11);
  const Body mesh = meshed(box(size.x(), size.y(), size.z()), "wood");
  const Body plain{"box", {model::ShapeKind::box, size}, 0.2, "wood", {}};
  EXPECT_NEAR(torque_scale(mesh), torque_scale(plain), 1e-8);
  const Pose start =
      make_pose(Vector3d(0.3, 0, 0.5),
                Eigen::AngleAxisd(0.4, Vector3d(1, 1, 0).normalized()).toRotationMatrix());
  std::vector<Pose> ends;
  for (const Body& body : {mesh, plain}) {
    auto world = std::move(
        *World::create(barrett(), make_pose(Vector3d(0, 0, 2)), Eigen::VectorXd::Zero(4)));
    ASSERT_TRUE(world->add_body(body, start));
    for (int i = 0; i < 140; ++i) world->step();  // falls and strikes the table with a corner
    ends.push_back(world->body_motion(0).X_WO);
  }
  EXPECT_LT((ends[0].translation() - ends[1].translation()).norm(), 2e-3);
}

/// A cone as a mesh of that many corners about its axis, as a cone stands.
Mesh cone_of(const model::Shape& cone, int corners) {
  Mesh made;
  for (const double end : {-0.5, 0.5})
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * std::numbers::pi * i / corners, z = end * cone.size.z();
      const double radius = model::radius_at(cone, z);
      made.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  made.vertices.emplace_back(0, 0, -0.5 * cone.size.z());
  made.vertices.emplace_back(0, 0, 0.5 * cone.size.z());
  for (int i = 0; i < corners; ++i) {
    const int j = (i + 1) % corners;
    made.triangles.emplace_back(i, j, corners + j);
    made.triangles.emplace_back(i, corners + j, corners + i);
    made.triangles.emplace_back(2 * corners, j, i);
    made.triangles.emplace_back(2 * corners + 1, corners + i, corners + j);
  }
  return made;
}

TEST_F(MeshFile, AConeIsWhatItsMeshIs) {
  const model::Shape cup{model::ShapeKind::cone, {0.025, 0.04, 0.1}};
  const Mesh mesh = cone_of(cup, 360);
  const SolidMesh cone = cone_mesh(cup);
  const auto solid = solid_of(mesh);
  ASSERT_TRUE(solid) << solid.error().message();
  EXPECT_LT((solid->p_OC - cone.p_OC).norm(), 1e-5);
  EXPECT_LT((solid->inertia_C - cone.inertia_C).norm() / cone.inertia_C.norm(), 1e-3);
  EXPECT_NEAR(solid->radius, cone.radius, 1e-6);
  // What bounds it is found again.
  const model::Shape found = model::bounding_shape(mesh);
  EXPECT_EQ(found.kind, model::ShapeKind::cone);
  EXPECT_LT((found.size - cup.size).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(model::bounding_shape(angle()).kind, model::ShapeKind::box);
  EXPECT_EQ(model::bounding_shape(cone_of({model::ShapeKind::cone, {0.03, 0.03, 0.1}}, 360)).kind,
            model::ShapeKind::cylinder);
}

TEST_F(MeshFile, AConeStandsAndAToppledOneRollsOnItsSide) {
  const Body cup{"cup", {model::ShapeKind::cone, {0.025, 0.04, 0.1}}, 0.1, "plastic", {}, {}};
  const auto rested = [&](const Pose& X_WO) {
    auto world = std::move(
        *World::create(barrett(), make_pose(Vector3d(0, 0, 1)), Eigen::VectorXd::Zero(4)));
    EXPECT_TRUE(world->add_body(cup, X_WO));
    for (int i = 0; i < 1500; ++i) world->step();
    return world->body_motion(0);
  };
  const BodyMotion standing = rested(make_pose(Vector3d(0, 0, 0.0505)));
  EXPECT_NEAR(standing.X_WO.translation().z(), 0.05, 1e-3);
  EXPECT_LT(angle_between(standing.X_WO.linear(), Eigen::Matrix3d::Identity()), 0.01);
  const BodyMotion lying = rested(
      make_pose(Vector3d(0, 0, 0.1), Eigen::AngleAxisd(1.2, Vector3d::UnitY()).toRotationMatrix()));
  // On its wall: the axis leans by half the angle of the cone, mouth up from the table.
  EXPECT_NEAR(lying.X_WO.linear()(2, 2), std::sin(std::atan(model::slope(cup.shape))), 0.02);
}

TEST_F(MeshFile, AScaledBodyIsTheBodyOfAScaledMesh) {
  for (const Vector3d& factor : {Vector3d(2, 2, 2), Vector3d(0.9, 1.1, 1.2)}) {
    Mesh larger = angle();
    for (Vector3d& vertex : larger.vertices) vertex = vertex.cwiseProduct(factor);
    const auto expected = solid_of(larger), small = solid_of(angle());
    ASSERT_TRUE(expected && small);
    const SolidMesh made = scaled(*small, factor);
    EXPECT_LT((made.p_OC - expected->p_OC).norm(), 1e-9);
    EXPECT_LT((made.inertia_C - expected->inertia_C).norm(), 1e-9);
    EXPECT_NEAR(made.radius, expected->radius, 1e-9);
    EXPECT_EQ(made.parts.parts.size(), expected->parts.parts.size());
  }
  const Body body = meshed(angle(), "wood"), large = scaled(body, 2);
  EXPECT_EQ(large.shape.size, 2 * body.shape.size);
  EXPECT_NEAR(torque_scale(large), 2 * torque_scale(body), 1e-9);
}

// A detection may say anything: a cone of a tenth of a millimetre made corners that were no
// numbers.
TEST_F(MeshFile, WhateverAConeIsItsCornersLieWithinIt) {
  for (const double below : {0.0, 1e-7, 1e-4, 4e-4, 0.01, 0.5})
    for (const double above : {0.0, 1e-4, 4e-4, 0.01, 0.5})
      for (const double height : {1e-7, 1e-4, 8e-4, 0.002, 0.1, 1.0}) {
        const model::Shape cone{model::ShapeKind::cone, {below, above, height}};
        if (!model::is_valid(cone)) continue;
        SCOPED_TRACE(cone.size.transpose());
        const auto corners = cone_mesh(cone).parts.parts.front();
        EXPECT_GE(corners.size(), 49u) << "one end at least is wide";
        for (const Vector3d& corner : corners) {
          ASSERT_TRUE(corner.allFinite());
          EXPECT_LE(model::signed_distance(cone, corner), 1e-9);
        }
      }
}

}  // namespace
