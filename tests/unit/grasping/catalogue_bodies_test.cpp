// Bodies of the catalogue's objects: with their mesh, and as they are seen.
#include "common/grasping/catalogue_bodies.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace prehend::grasping {
namespace {

/// A wedge of 40 x 60 x 80 mm, whose mass is not in the middle of its box, and a can.
CatalogueBodies wedge_and_can() {
  const auto folder =
      std::filesystem::temp_directory_path() / ("catalogue-bodies" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "wedge.obj")
      << "v 0 0 0\nv 40 0 0\nv 0 60 0\nv 0 0 80\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  std::ofstream(folder / "catalogue.toml")
      << "[[object]]\nname = \"Wedge\"\nshape = \"box\"\nsize = [0.04, 0.06, 0.08]\nmass = 0.1\n"
         "material = \"wood\"\nmesh = \"wedge.obj\"\nmesh_scale = 0.001\n"
         "[[object]]\nname = \"Can\"\nshape = \"cylinder\"\nsize = [0.03, 0.03, 0.1]\nmass = 0.3\n"
         "material = \"metal\"\n";
  const auto catalogue = model::Catalogue::load(folder / "catalogue.toml");
  std::filesystem::remove_all(folder);
  EXPECT_TRUE(catalogue) << catalogue.error().message();
  return CatalogueBodies::create(*catalogue).value();
}

TEST(CatalogueBodies, AMeshIsThereAndWhatIsSeenOfItIsAsLargeAsItIsSeen) {
  const CatalogueBodies bodies = wedge_and_can();
  const Body* wedge = bodies.find("Wedge");
  ASSERT_TRUE(wedge && wedge->mesh);
  // A quarter of the way from its right angle: that is, 10, 15 and 20 mm before the middle.
  EXPECT_LT((centre_of_mass(*wedge) + Eigen::Vector3d(0.01, 0.015, 0.02)).norm(), 1e-6);
  model::Shape seen = wedge->shape;
  seen.size *= 1.1;
  const Body larger = bodies.seen("Wedge", seen);
  ASSERT_TRUE(larger.mesh);
  EXPECT_EQ(larger.shape, seen);
  EXPECT_NEAR(torque_scale(larger) / torque_scale(*wedge), 1.1, 1e-9);
  // Higher and narrower: the mesh, too, so that it stands where its shape does.
  seen.size = wedge->shape.size.cwiseProduct(Eigen::Vector3d(0.9, 0.9, 1.2));
  EXPECT_NEAR(bodies.seen("Wedge", seen).mesh->p_OC.z() / wedge->mesh->p_OC.z(), 1.2, 1e-9);
  seen.size *= 2;
  EXPECT_FALSE(bodies.seen("Wedge", seen).mesh) << "that is something else";
  EXPECT_FALSE(bodies.seen("Wedge", {model::ShapeKind::sphere, wedge->shape.size}).mesh);
}

TEST(CatalogueBodies, WhatNobodyKnowsIsAsHeavyAsThingsOfItsSizeAre) {
  const CatalogueBodies bodies = wedge_and_can();
  const model::Shape can = bodies.find("Can")->shape;
  EXPECT_EQ(bodies.seen("Can", can).mass, 0.3);
  EXPECT_EQ(bodies.seen("Can", can).material, "metal");
  const Body other = bodies.seen("Vase", can);
  EXPECT_EQ(other.name, "Vase");
  EXPECT_NEAR(other.mass, 300 * model::volume(can), 1e-9);
  EXPECT_EQ(bodies.find("Vase"), nullptr);
}

}  // namespace
}  // namespace prehend::grasping
