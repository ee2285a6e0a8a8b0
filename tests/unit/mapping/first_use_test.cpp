// A hand that somebody brings is trained when it is first needed, and again when it has changed. A
// jaw with one motor, which is the quickest of the hands; as if it came from elsewhere.
#include "services/mapping/tools/training/first_use.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "common/base/file_text.hpp"
#include "services/mapping/files/mapping_model_file.hpp"
#include "services/mapping/tools/training/demonstrator.hpp"
#include "services/mapping/tools/training/robot_grasps.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::mapping {
namespace {

namespace fs = std::filesystem;

class FirstUse : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("prehend_first_use_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    fs::copy(test::in_sources("common/models/hands/parallel_jaw"), folder_,
             fs::copy_options::recursive);
    std::string toml = read_file(folder_ / "hand.toml").value();
    toml.replace(toml.find("parallel_jaw"), 12, "pincers");
    ASSERT_TRUE(write_file(folder_ / "hand.toml", toml));
  }
  void TearDown() override { fs::remove_all(folder_); }

  model::HandModel hand() const { return model::HandModel::load(folder_).value(); }
  ModelPlaces ready(Needs needs = Needs::model_and_grasps) const {
    return ready_places(folder_, hand(), needs).value();
  }
  std::string bytes(const char* file) const { return read_file(folder_ / file).value_or(""); }

  fs::path folder_;
};

TEST_F(FirstUse, TrainsOnceBesideTheHand) {
  const ModelPlaces made = ready();
  EXPECT_EQ(made.model, folder_ / "hand.mapping");
  EXPECT_FALSE(load_robot_grasps(made.grasps, hand(), made.made_for)->empty());
  const auto model = load_mapping_model(made.model, hand(), made.made_for);
  ASSERT_TRUE(model) << model.error().message();

  // The jaw closes as the human hand does; its values are the way of a finger from the middle, m.
  Demonstrator person("somebody", 7, {});
  const double open = model->direct(person.read({0, 0, 0, 0, 0})).dof[0];
  const double half = model->direct(person.read({0.5, 0.5, 0.5, 0.5, 0.5})).dof[0];
  const double closed = model->direct(person.read({1, 1, 1, 1, 1})).dof[0];
  EXPECT_GT(open, 0.035);
  // The narrowest object of the catalogue is 30 mm wide: a hand that closes would grip it.
  EXPECT_LT(half, 0.015);
  EXPECT_LT(closed, 0.015);
  for (const auto shape : {model::ShapeKind::cylinder, model::ShapeKind::box})
    EXPECT_TRUE(model->known_as({shape, Eigen::Vector3d::Constant(0.05)}))
        << model::to_string(shape);

  // It is there now: the files stay as they are.
  const auto written = fs::last_write_time(made.model);
  ready();
  EXPECT_EQ(fs::last_write_time(made.model), written);
}

TEST_F(FirstUse, TrainsAnewWhatDoesNotFitTheHand) {
  ready();
  const std::string first = bytes("hand.mapping");

  // Another mass of a pad: neither the name nor the DoF of the hand says so.
  std::string urdf = bytes("hand.urdf");
  urdf.replace(urdf.find("0.12"), 4, "0.14");
  ASSERT_TRUE(write_file(folder_ / "hand.urdf", urdf));
  ModelPlaces made = ready();
  EXPECT_NE(bytes("hand.mapping"), first);
  EXPECT_TRUE(load_mapping_model(made.model, hand(), made.made_for));
  EXPECT_TRUE(load_robot_grasps(made.grasps, hand(), made.made_for));

  // Cut short, as after a full disk. The grasps still fit, and are not closed again.
  const std::string second = bytes("hand.mapping");
  const auto closed = fs::last_write_time(made.grasps);
  fs::resize_file(made.model, second.size() / 2);
  made = ready();
  EXPECT_TRUE(bytes("hand.mapping") == second);  // the same from the same, byte for byte
  EXPECT_EQ(fs::last_write_time(made.grasps), closed);
}

// What somebody trained by other means does not say for which version of the hand it is; nor do
// models that were made before there were digests.
TEST_F(FirstUse, KeepsAModelThatDoesNotSayWhatItIsFor) {
  const ModelPlaces places = ready();
  ModelTraits traits = load_mapping_model(places.model, hand())->traits();
  traits.made_for.clear();
  const auto own =
      MappingModel::create(hand(), traits, load_mapping_model(places.model, hand())->networks());
  ASSERT_TRUE(save_mapping_model(places.model, *own, hand()));
  const std::string kept = bytes("hand.mapping");
  std::ofstream(folder_ / "hand.toml", std::ios::app) << "# a remark\n";
  ready(Needs::model);
  EXPECT_TRUE(bytes("hand.mapping") == kept);
}

}  // namespace
}  // namespace prehend::mapping
