// Where hands are looked for by name, and where what was made for them lies.
#include "services/mapping/files/model_places.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

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

// A message says «barrett» of a hand that this process was given as a folder.
TEST_F(Places, OthersNameAlsoWhatThisProcessWasToldOf) {
  const path told = test::in_sources("common/models/hands/barrett");
  EXPECT_EQ(model::named_hand("barrett", {"", told}), told);
  EXPECT_EQ(model::named_hand("barrett", {test::in_sources("common/models/hands/dlr")}),
            share_directory() / "models" / "hands" / "barrett");
  EXPECT_FALSE(model::named_hand("beside", {told}));
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

/// Whether this process may write there as one that is not root.
class Nobody {
 public:
  Nobody() : was_(::geteuid()) {
    if (was_ == 0 && ::seteuid(65534) != 0) ADD_FAILURE() << "cannot be nobody";
  }
  ~Nobody() {
    if (::seteuid(was_) != 0) ADD_FAILURE() << "cannot be root again";
  }
  Nobody(const Nobody&) = delete;
  Nobody& operator=(const Nobody&) = delete;

 private:
  uid_t was_;
};

// A hand on a shared disk, or one that an administrator put there.
TEST_F(Places, WhatMayNotLieWithItsHandIsKeptForTheUser) {
  const path folder = root_ / "here" / "beside";
  ::setenv("XDG_STATE_HOME", (root_ / "state").c_str(), 1);
  std::filesystem::permissions(folder, std::filesystem::perms(0555));
  ModelPlaces kept, changed;
  {
    const Nobody nobody;
    kept = model_places(folder);
  }
  std::filesystem::permissions(folder, std::filesystem::perms(0755));
  std::ofstream(folder / "hand.toml") << "# another hand\n";
  std::filesystem::permissions(folder, std::filesystem::perms(0555));
  {
    const Nobody nobody;
    changed = model_places(folder);
  }
  std::filesystem::permissions(folder, std::filesystem::perms(0755));
  ::unsetenv("XDG_STATE_HOME");
  EXPECT_EQ(kept.model.parent_path().parent_path(), root_ / "state/prehend/hands");
  EXPECT_EQ(kept.grasps.parent_path(), kept.model.parent_path());
  EXPECT_EQ(kept.scheme, folder / "scheme.toml");
  // Two versions of a hand do not share a place.
  EXPECT_NE(changed.model, kept.model);
  EXPECT_NE(changed.made_for, kept.made_for);
}

TEST_F(Places, WhatWasMadeForAHandIsKnownByAllOfItsFiles) {
  const path folder = root_ / "here" / "beside";
  std::set<std::string> digests{model_places(folder).made_for};
  for (const char* file : {"hand.urdf", "hand.toml", "scheme.toml"}) {
    std::ofstream(folder / file) << "changed\n";
    digests.insert(model_places(folder).made_for);
  }
  EXPECT_EQ(digests.size(), 4u);
  std::ofstream(folder / "picture.png") << "says nothing of it";
  digests.insert(model_places(folder).made_for);
  EXPECT_EQ(digests.size(), 4u);
  EXPECT_EQ(model_places("barrett").made_for, "");
}

}  // namespace
}  // namespace prehend::mapping
