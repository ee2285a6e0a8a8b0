// Schemes as data: properties of every file in schemes/, and what a bad file is refused for. Robot
// values are held against the hand's limits to 1e-9, which is rounding of degrees.
#include "services/mapping/tools/training/scheme.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "services/mapping/tools/training/demonstrator.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/mapping/fixtures.hpp"

namespace prehend::mapping {
namespace {

const std::filesystem::path folder = test::in_sources("services/mapping/schemes");

std::vector<std::string> all_schemes() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().stem());
  std::sort(names.begin(), names.end());
  return names;
}

/// The hand whose name the scheme's begins with.
std::string hand_of(const std::string& scheme) {
  for (const std::string& hand : test::hand_names())
    if (scheme.starts_with(hand)) return hand;
  return {};
}

class EveryScheme : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    auto hand =
        model::HandModel::load(test::in_sources("common/models/hands/") + hand_of(GetParam()));
    ASSERT_TRUE(hand) << hand.error().message();
    hand_.emplace(std::move(*hand));
    auto scheme = Scheme::load(folder / (GetParam() + ".toml"), *hand_);
    ASSERT_TRUE(scheme) << scheme.error().message();
    scheme_ = std::move(*scheme);
  }

  bool within_limits(const Eigen::VectorXd& dof) const {
    return ((dof - scheme_.lower).array() > -1e-9).all() &&
           ((scheme_.upper - dof).array() > -1e-9).all();
  }

  std::optional<model::HandModel> hand_;
  Scheme scheme_;
};

TEST_P(EveryScheme, HasPostureSetsOfEachSize) {
  for (const int count : {4, 7, 10, 13}) {
    const int levels = (count - 1) / 3;
    const auto set = scheme_.posture_set(count);
    EXPECT_EQ(set.size(), 1 + levels * scheme_.closed.size());
    if (scheme_.closed.size() == 3) {
      EXPECT_EQ(set.size(), static_cast<std::size_t>(count));
    }
    EXPECT_EQ(set.front().name, "open");
    std::set<std::string> names;
    for (const SchemePosture& posture : set) {
      names.insert(posture.name);
      EXPECT_TRUE(within_limits(posture.robot)) << posture.name;
      for (const double closure : posture.human) {
        EXPECT_GE(closure, 0) << posture.name;
        EXPECT_LE(closure, 1) << posture.name;
      }
    }
    EXPECT_EQ(names.size(), set.size());
    // The last level is the file's own posture; levels are equal steps towards it.
    for (std::size_t i = 0; i < scheme_.closed.size(); ++i)
      for (int level = 1; level <= levels; ++level) {
        const SchemePosture& posture =
            set[1 + i * static_cast<std::size_t>(levels) + static_cast<std::size_t>(level - 1)];
        const Eigen::VectorXd whole = scheme_.closed[i].robot - scheme_.open.robot;
        EXPECT_TRUE((posture.robot - scheme_.open.robot)
                        .isApprox(whole * (static_cast<double>(level) / levels), 1e-12));
      }
  }
}

TEST_P(EveryScheme, ClosesTheHandWithTheFingersThatDriveIt) {
  // Every DoF that closes the hand is closed by some human finger, and none by two; a finger that
  // moves nothing, as the little one of a parallel jaw, is allowed.
  for (std::size_t i = 0; i < hand_->dofs().size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    double sum = 0;
    for (const SchemePosture& closed : scheme_.closed) {
      const double way = (closed.robot[k] - scheme_.open.robot[k]) * hand_->dofs()[i].closing;
      EXPECT_GE(way, 0) << hand_->dofs()[i].name;
      sum += way;
    }
    const bool closes = hand_->dofs()[i].closing != 0;
    EXPECT_EQ(closes, sum > 0) << hand_->dofs()[i].name;
  }
}

TEST_P(EveryScheme, HasTheFourCombinationsOfFigure517) {
  const auto combinations = scheme_.combinations();
  ASSERT_EQ(combinations.size(), 4u);
  EXPECT_EQ(combinations[0].name, "index and little half");
  EXPECT_EQ(combinations[3].name, "thumb and little closed");
  for (const SchemePosture& posture : combinations) {
    EXPECT_TRUE(within_limits(posture.robot)) << posture.name;
    for (const int count : {4, 7, 10, 13})
      for (const SchemePosture& trained : scheme_.posture_set(count))
        EXPECT_NE(posture.human, trained.human) << posture.name;
  }
  // Half of it is half way to the whole.
  EXPECT_TRUE((combinations[0].robot - scheme_.open.robot)
                  .isApprox((combinations[1].robot - scheme_.open.robot) / 2, 1e-12));
}

TEST_P(EveryScheme, HasPreshapesForEveryGraspType) {
  for (const GraspType type : grasp_types) {
    int count = 0;
    for (const Preshape& preshape : scheme_.preshapes) {
      EXPECT_TRUE(within_limits(preshape.robot));
      EXPECT_EQ(preshape.resting.size(), hand_->dofs().size());
      count += static_cast<int>(std::count(preshape.types.begin(), preshape.types.end(), type));
    }
    EXPECT_GT(count, 0) << to_string(type);
  }
}

// Postures that a person shows are told apart by the glove: their features differ by more than the
// tracker's noise (1 mm a coordinate).
TEST_P(EveryScheme, HasPosturesThatAGloveTellsApart) {
  DemonstratorOptions exact;
  exact.scale_sigma = exact.scale_error = exact.mounting = exact.mounting_turn = exact.noise = 0;
  Demonstrator person("someone", 1, exact);
  auto set = scheme_.posture_set(13);
  for (const SchemePosture& posture : scheme_.combinations()) set.push_back(posture);
  for (std::size_t i = 0; i < set.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_GT((person.read(set[i].human, set[i].splay) - person.read(set[k].human, set[k].splay))
                    .norm(),
                0.003)
          << set[i].name << ", " << set[k].name;
}

INSTANTIATE_TEST_SUITE_P(All, EveryScheme, testing::ValuesIn(all_schemes()),
                         [](const auto& given) { return given.param; });

TEST(Schemes, ExistForEveryHandAndThoseOfTheThesisForBarrett) {
  const auto names = all_schemes();
  for (const char* name : {"barrett_fixed_spread", "barrett_alternative_1"})
    EXPECT_THAT(names, testing::Contains(name));
  int trained = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.parent_path() / "trained"))
    if (entry.path().extension() == ".mapping") {
      EXPECT_THAT(names, testing::Contains(entry.path().stem().string())) << "is trained";
      ++trained;
    }
  EXPECT_GT(trained, 0);
  const auto fixed = Scheme::load(folder / "barrett_fixed_spread.toml", barrett());
  ASSERT_TRUE(fixed);
  for (const SchemePosture& posture : fixed->posture_set(13)) EXPECT_EQ(posture.robot[0], 0);
}

class BadScheme : public testing::Test {
 protected:
  /// What the file is refused for after one text in it became another, and perhaps also a second
  /// one.
  std::string refusal(const std::string& from, const std::string& to, const std::string& also = "",
                      const std::string& by = "") {
    std::ifstream in(folder / "barrett.toml");
    std::string text((std::istreambuf_iterator<char>(in)), {});
    const auto place = text.find(from);
    EXPECT_NE(place, std::string::npos) << from;
    text.replace(place, from.size(), to);
    EXPECT_NE(text.find(also), std::string::npos) << also;
    text.replace(text.find(also), also.size(), by);
    const auto file = std::filesystem::path(testing::TempDir()) / "prehend_scheme_test.toml";
    std::ofstream(file) << text;
    const auto loaded = Scheme::load(file, barrett());
    std::filesystem::remove(file);
    return loaded ? "loaded" : loaded.error().message();
  }
};

TEST_F(BadScheme, IsRefusedByName) {
  using testing::HasSubstr;
  EXPECT_EQ(refusal("limit", "limit"), "loaded");
  EXPECT_THAT(refusal("hand = \"barrett\"", "hand = \"dlr\""),
              HasSubstr("not for the hand «barrett»"));
  EXPECT_THAT(refusal("hand = \"barrett\"", "hand = "), HasSubstr("prehend_scheme_test.toml"));
  EXPECT_THAT(refusal("[open]", "[opened]"), HasSubstr("no posture «open»"));
  EXPECT_THAT(refusal("\"index\"", "\"pointer\""), HasSubstr("no closed posture «index»"));
  EXPECT_THAT(refusal("\"index\"", "\"thumb\""), HasSubstr("closed «thumb»: is there twice"));
  EXPECT_THAT(refusal("human = [0, 0, 0, 1, 1]", "human = [0, 0, 0, 0, 0]"),
              HasSubstr("closed «little»: is the open hand"));
  EXPECT_THAT(refusal("human = [0, 0, 0, 1, 1]", "human = [0, 0, 0, 0, 2]"),
              HasSubstr("closed «little»: «human» is outside 0 to 1"));
  EXPECT_THAT(refusal("human = [0, 0, 0, 1, 1]", "human = [0, nan, 0, 0, 2]"),
              HasSubstr("closed.human is not a finite number"));
  EXPECT_THAT(refusal("human = [0, 0, 0, 1, 1]", "human = [0, 0, 0, 1]"),
              HasSubstr("not five numbers"));
  EXPECT_THAT(refusal("robot = [45, 0, 0, 0]", "robot = [45, 0, 0]"),
              HasSubstr("«robot» is not 4 numbers"));
  EXPECT_THAT(refusal("robot = [45, 0, 0, 0]", "robot = [46, 0, 0, 0]"),
              HasSubstr("outside the limits"));
  EXPECT_THAT(refusal("robot = [45, 0, 0, 0]", "robot = [inf, 0, 0, 0]"),
              HasSubstr("closed.robot is not a finite number"));
  EXPECT_THAT(refusal("robot = [45, 0, 0, 0]", "robot = \"fist\""),
              HasSubstr("the hand has no posture «fist»"));
  EXPECT_THAT(refusal("dofs = [\"spread\"]", "dofs = [\"spreading\"]"),
              HasSubstr("no DoF «spreading»"));
  EXPECT_THAT(refusal("upper = 45", "upper = 400"), HasSubstr("wider than the hand's"));
  EXPECT_THAT(refusal("upper = 45", "upper = nan"),
              HasSubstr("limit.upper is not a finite number"));
  EXPECT_THAT(refusal("\"precision\"", "\"pliers\""), HasSubstr("unknown grasp type «pliers»"));
  EXPECT_THAT(refusal(", \"precision\"", "", "robot = [15, 0, 0, 0]",
                      "robot = [15, 0, 0, 0]\ntypes = [\"power wrap\"]"),
              HasSubstr("has no preshape for precision grasps"));
  EXPECT_THAT(
      refusal("hand = \"barrett\"", "hand = \"barrett\"\nlimit = [1]", "[[limit]]", "[other]"),
      HasSubstr("limit: is not a table"));
  EXPECT_THAT(refusal("dofs = [\"spread\"]", "dofs = []"), HasSubstr("limit: names no DoF"));
  EXPECT_THAT(refusal("human = [0, 0, 0, 1, 1]", "splay = 2\nhuman = [0, 0, 0, 1, 1]"),
              HasSubstr("closed «little»: «splay» is outside 0 to 1"));
}

}  // namespace
}  // namespace prehend::mapping
