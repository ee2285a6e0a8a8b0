// Views cut out of a rendered camera's pictures against the renderer's own masks; what is added to
// a catalogue is read back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/base/file_text.hpp"
#include "common/model/bounding_shape.hpp"
#include "common/model/mesh.hpp"
#include "services/recognition/core/rendering/renderer.hpp"
#include "services/recognition/core/rendering/strangers.hpp"
#include "services/recognition/files/catalogue_entry.hpp"
#include "services/recognition/tools/taking/view_taker.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::recognition {
namespace {

/// The lab's camera, at half its size.
CameraModel camera() {
  CameraModel made;
  made.X_WC = make_pose({0, -0.75, 0.8},
                        Eigen::Quaterniond(0.36650123, -0.93041757, 0, 0).toRotationMatrix());
  CameraModel half = made.scaled(0.5);
  half.height = made.height / 2;
  half.width = made.width / 2;
  return half;
}

class Table : public ::testing::Test {
 protected:
  Picture shot(const model::Scene& scene) {
    RenderOptions options;
    options.noise_seed = ++noise_;
    options.sensor_noise = 2;
    return renderer_.render(scene, camera(), options);
  }
  model::Scene with(double yaw, double x = 0.02) {
    model::Scene scene;
    const Eigen::Vector3d half = model::half_extents(catalogue_.find("Toy car")->shape);
    scene.objects.push_back(
        {"Toy car",
         make_pose({x, 0.05, half.z()},
                   Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix())});
    return scene;
  }
  int show(ViewTaker& taker, const model::Scene& scene, int pictures) {
    int taken = 0;
    for (int i = 0; i < pictures; ++i) taken += taker.see(shot(scene));
    return taken;
  }
  model::Catalogue catalogue_ =
      *model::Catalogue::load(test::in_sources("common/models/objects/catalogue.toml"));
  Renderer renderer_{catalogue_};
  std::uint64_t noise_ = 0;
};

TEST_F(Table, TurnedObjectGivesAViewEachTimeItRests) {
  ViewTaker taker(3);
  EXPECT_EQ(show(taker, {}, 12), 0);
  for (const double yaw : {0.3, 1.4, 2.6}) {
    EXPECT_EQ(show(taker, with(yaw), 6), 1) << yaw << " " << taker.hint();
    // The mask is the object: compared with the renderer's, shadow left out.
    const Plane truth = renderer_.mask(with(yaw), 0, camera());
    const Plane& mask = taker.views().back().mask;
    const auto area = [](const Plane& p) {
      return static_cast<double>(std::count(p.values.begin(), p.values.end(), 1));
    };
    EXPECT_NEAR(area(mask) / area(truth), 1, 0.15);
  }
  EXPECT_TRUE(taker.done());
  EXPECT_EQ(show(taker, with(0.9), 6), 0);  // it has enough
}

TEST_F(Table, TheSameViewIsNotTakenTwice) {
  ViewTaker taker(5);
  show(taker, {}, 12);
  EXPECT_EQ(show(taker, with(0.3), 20), 1);
}

TEST_F(Table, HandAtTheEdgeIsWaitedFor) {
  ViewTaker taker(5);
  show(taker, {}, 12);
  for (int i = 0; i < 8; ++i) {
    Picture picture = shot(with(0.3));
    for (int y = 100; y < 140; ++y)  // a sleeve from the left edge to the object
      for (int x = 0; x < picture.width / 2; ++x) std::copy_n("\xd0\xa0\x80", 3, picture.at(x, y));
    EXPECT_FALSE(taker.see(picture));
  }
  EXPECT_NE(taker.hint().find("hand"), std::string::npos);
  EXPECT_EQ(show(taker, with(0.3), 6), 1);
}

TEST_F(Table, AnotherSizeStartsAnewAndNothingIsNoView) {
  ViewTaker taker(5);
  EXPECT_FALSE(taker.see(Picture()));
  show(taker, {}, 12);
  EXPECT_FALSE(taker.see(Picture(50, 40)));
  EXPECT_EQ(show(taker, with(0.3), 6), 0);  // that is the table now
  EXPECT_EQ(taker.views().size(), 0u);
}

TEST_F(Table, WhatIsAddedToACatalogueIsThereThroughALinkToo) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("objects-add" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const auto real = folder / "real.toml", link = folder / "link.toml";
  std::filesystem::copy_file(test::in_sources("common/models/objects/catalogue.toml"), real);
  std::filesystem::create_symlink(real, link);
  ViewTaker taker(1);
  show(taker, {}, 12);
  show(taker, with(0.3), 6);
  ASSERT_TRUE(taker.done());
  const auto object =
      described_by("My mug", {model::ShapeKind::cylinder, {0.04, 0.04, 0.1}}, 0.3, taker.views());
  const auto added = append_to_catalogue(link, object);
  EXPECT_TRUE(added) << (added ? "" : added.error().message());
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  const auto after = model::Catalogue::load(real);
  ASSERT_TRUE(after);
  EXPECT_EQ(after->objects().size(), catalogue_.objects().size() + 1);
  const model::CatalogueObject* mug = after->find("My mug");
  ASSERT_TRUE(mug);
  EXPECT_EQ(mug->shape, object.shape);
  EXPECT_EQ(mug->appearance.colours.size(), object.appearance.colours.size());
  EXPECT_FALSE(append_to_catalogue(link, object));
  model::CatalogueObject odd = object;
  odd.name = "a\"b";  // would break the file; it must stay as it was
  EXPECT_FALSE(append_to_catalogue(link, odd));
  EXPECT_TRUE(model::Catalogue::load(real));
  EXPECT_FALSE(append_to_catalogue(folder / "absent.toml", object));
  std::filesystem::create_directory(folder / "real.toml.new");  // where it would be written first
  odd.name = "Another";
  const auto blocked = append_to_catalogue(real, odd);
  ASSERT_FALSE(blocked);
  EXPECT_THAT(blocked.error().message(),
              testing::HasSubstr("real.toml.new: cannot be written (is the place writable?)"));
  std::filesystem::remove_all(folder);
}

/// A tetrahedron in millimetres, 40 wide and 60 high.
void write_tetrahedron(const std::filesystem::path& file) {
  std::ofstream(file)
      << "v 0 0 0\nv 40 0 0\nv 0 40 0\nv 0 0 60\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
}

TEST_F(Table, AMeshComesWithItsObject) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("mesh-add" + std::to_string(getpid()));
  std::filesystem::create_directories(folder / "elsewhere");
  const auto catalogue = folder / "catalogue.toml", mesh = folder / "elsewhere" / "mine.obj";
  std::filesystem::copy_file(test::in_sources("common/models/objects/catalogue.toml"), catalogue);
  write_tetrahedron(mesh);
  const auto read = model::load_mesh(mesh, 0.001);
  ASSERT_TRUE(read) << read.error().message();
  const auto object = imagined("Wedge", model::bounding_shape(*read), 0.1);
  EXPECT_EQ(imagined("Wedge", object.shape, 0.1).appearance.colours, object.appearance.colours);
  const auto added = append_to_catalogue(catalogue, object, MeshFile{mesh, 0.001});
  ASSERT_TRUE(added) << added.error().message();
  model::CatalogueObject odd = object;
  odd.name = "no\"name";
  EXPECT_FALSE(append_to_catalogue(catalogue, odd, MeshFile{mesh, 0.001}));
  EXPECT_FALSE(std::filesystem::exists(folder / "no\"name.obj"))
      << "what is refused leaves nothing";
  std::filesystem::remove_all(folder / "elsewhere");
  const auto after = model::Catalogue::load(catalogue);
  ASSERT_TRUE(after) << after.error().message();
  const model::CatalogueObject* wedge = after->find("Wedge");
  ASSERT_TRUE(wedge && wedge->mesh);
  EXPECT_LT(model::bounds(*wedge->mesh).center().norm(), 1e-9);
  EXPECT_LT((model::bounds(*wedge->mesh).sizes() - Eigen::Vector3d(0.04, 0.04, 0.06)).norm(), 1e-6);
  // Guards: a copy of one's own could not be read, since its meshes were left behind.
  const auto own = folder / "own" / "mine.toml";
  const auto copied = copy_catalogue(catalogue, own);
  ASSERT_TRUE(copied) << copied.error().message();
  const auto mine = model::Catalogue::load(own);
  ASSERT_TRUE(mine) << mine.error().message();
  EXPECT_EQ(mine->objects().size(), after->objects().size());
  EXPECT_TRUE(std::filesystem::exists(folder / "own" / "Wedge.obj"));
  std::string beside = read_file(catalogue).value();
  beside.replace(beside.find("\"Wedge.obj"), 1, "\"../");
  std::ofstream(folder / "own" / "beside.toml") << beside;
  const auto outside = copy_catalogue(folder / "own" / "beside.toml", folder / "far" / "mine.toml");
  ASSERT_FALSE(outside) << "a copy would write outside its folder";
  EXPECT_THAT(outside.error().message(), testing::HasSubstr("Wedge lies outside"));
  // A mesh that is not as large as the shape that is to bound it: somebody's unit is another.
  std::string text = read_file(catalogue).value();
  text.replace(text.find("mesh_scale = 0.001"), 18, "mesh_scale = 0.002");
  std::ofstream(catalogue) << text;
  const auto wrong = model::Catalogue::load(catalogue);
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message(), testing::HasSubstr("80.0 x 80.0 x 120.0 mm"));
  std::filesystem::remove(folder / "Wedge.obj");
  EXPECT_FALSE(model::Catalogue::load(catalogue)) << "its mesh is gone";
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace prehend::recognition
