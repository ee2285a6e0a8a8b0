// Where hands are looked for by name, and where what was made for them lies.
#include "services/mapping/files/model_places.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "common/base/paths.hpp"
#include "common/model/hand_model.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::mapping {
namespace {

using std::filesystem::path;

/// A folder of the user's data and one to stand in, both with hands.
class Places : public testing::Test {
 protected:
  void SetUp() override {
    root_ = path(testing::TempDir()) / ("prehend_places_" + std::to_string(getpid()));
    std::filesystem::create_directories(root_);
    root_ = std::filesystem::canonical(root_);
    before_ = std::filesystem::current_path();
    if (const char* data = std::getenv("XDG_DATA_HOME")) data_ = data;
    ::setenv("XDG_DATA_HOME", (root_ / "data").c_str(), 1);
    for (const char* folder : {"data/prehend/models/hands/kept", "data/prehend/models/hands/both",
                               "here/both", "here/beside", "here/barrett"}) {
      std::filesystem::create_directories(root_ / folder);
      std::ofstream(root_ / folder / "hand.toml") << "";
    }
    std::filesystem::create_directories(root_ / "here" / "empty");
    std::filesystem::current_path(root_ / "here");
  }
  void TearDown() override {
    std::filesystem::current_path(before_);
    data_.empty() ? ::unsetenv("XDG_DATA_HOME") : ::setenv("XDG_DATA_HOME", data_.c_str(), 1);
    std::filesystem::remove_all(root_);
  }

  path root_, before_;
  std::string data_;
};

TEST_F(Places, AHandIsOursThenTheUsersThenOfThisFolder) {
  const path ours = share_directory() / "models" / "hands";
  const path kept = root_ / "data/prehend/models/hands";
  EXPECT_EQ(model::hand_directory("barrett"), ours / "barrett");
  EXPECT_EQ(model::hand_directory("kept"), kept / "kept");
  EXPECT_EQ(model::hand_directory("both"), kept / "both");
  EXPECT_EQ(model::hand_directory("beside"), root_ / "here" / "beside");
  EXPECT_EQ(model::hand_directory("./both"), "./both");
  EXPECT_EQ(model::hand_directory("empty"), ours / "empty");  // for the message
  EXPECT_EQ(model::hand_directory("nowhere"), ours / "nowhere");
  EXPECT_TRUE(model::hand_hint().find("kept") != std::string::npos);
}

TEST_F(Places, OthersNameOnlyWhatIsKept) {
  EXPECT_TRUE(model::named_hand("kept"));
  EXPECT_FALSE(model::named_hand("beside"));
  EXPECT_FALSE(model::named_hand("../hands/kept"));
  EXPECT_FALSE(model::named_hand((root_ / "here" / "beside").string()));
}

TEST_F(Places, ModelsLieWithTheirHand) {
  const ModelPlaces ours = model_places("barrett");
  EXPECT_EQ(ours.grasps, share_directory() / "trained" / "barrett.grasps");
  EXPECT_EQ(ours.model, share_directory() / "trained" / "barrett.mapping");
  EXPECT_EQ(ours.scheme, share_directory() / "schemes" / "barrett.toml");
  // Ours by whatever path.
  EXPECT_EQ(model_places(test::in_sources("common/models/hands/barrett/")).model, ours.model);
  const ModelPlaces own = model_places("beside");
  EXPECT_EQ(own.grasps, root_ / "here/beside/hand.grasps");
  EXPECT_EQ(own.model, root_ / "here/beside/hand.mapping");
  EXPECT_EQ(own.scheme, root_ / "here/beside/scheme.toml");
  EXPECT_EQ(model_places("./barrett").model, "./barrett/hand.mapping");
}

}  // namespace
}  // namespace prehend::mapping
