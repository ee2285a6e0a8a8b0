// The scheme that is derived for a hand without one: for the hands of the lab, for the same when
// hand.toml does not say which human finger a fingertip follows, for imported ones, and for made
// ones of two to five fingers and 1 to 25 DoF. What must hold of written schemes (scheme_test.cpp)
// must hold of these.
#include "services/mapping/tools/training/derived_scheme.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>

#include "common/base/file_text.hpp"
#include "services/planner/tools/hand_import/make_hand.hpp"
#include "tests/support/hands.hpp"
#include "tests/support/made_hands/made_hands.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/support/popular_hands/popular_hands.hpp"

namespace prehend::mapping {
namespace {

using Eigen::VectorXd;

const std::filesystem::path folder = test::in_sources("common/models/hands");

/// A hand of the lab whose hand.toml says nothing of human fingers.
model::HandModel untold(const std::string& name) {
  std::string toml = read_file(folder / name / "hand.toml").value();
  for (std::size_t at; (at = toml.find("\nhuman = ")) != std::string::npos;)
    toml.erase(at, toml.find('\n', at + 1) - at);
  return model::HandModel::parse(read_file(folder / name / "hand.urdf").value(), toml).value();
}

/// Imported with so short a search as does for the sense in which fingers close.
model::HandModel imported(const popular_hands::PopularHand& hand) {
  const auto robot = planner::read_robot(hand.urdf);
  return planner::make_hand(robot.value(), hand.name, planner::mesh_files("."),
                            {.samples = 150, .refinements = 5, .shapings = 20, .step = 0.004})
      .value()
      .model;
}

std::vector<model::HandModel> all_hands() {
  std::vector<model::HandModel> hands;
  for (const std::string& name : test::hand_names()) {
    hands.push_back(test::hand(name));
    hands.push_back(untold(name));
  }
  for (const auto& popular : popular_hands::popular_hands()) hands.push_back(imported(popular));
  for (const test::MadeHand& made : test::made_hands()) hands.push_back(test::made_hand(made));
  return hands;
}

class EveryHand : public testing::Test {
 protected:
  static const std::vector<model::HandModel>& hands() {
    static const std::vector<model::HandModel> all = all_hands();
    return all;
  }
};

// A thumb of the Rutgers hand once came out that opened while the human one closed.
TEST_F(EveryHand, IsClosedByHumanFingersThatClose) {
  for (const model::HandModel& hand : hands()) {
    SCOPED_TRACE(hand.name());
    const Scheme scheme = derive_scheme(hand);
    ASSERT_EQ(scheme.closed.size(), 3u);
    VectorXd together = scheme.open.robot;
    for (const SchemePosture& closed : scheme.closed) together += closed.robot - scheme.open.robot;
    for (std::size_t i = 0; i < hand.dofs().size(); ++i) {
      const model::HandDof& dof = hand.dofs()[i];
      const auto k = static_cast<Eigen::Index>(i);
      for (const SchemePosture& closed : scheme.closed) {
        const double way = closed.robot[k] - scheme.open.robot[k];
        EXPECT_GE(way * dof.closing, 0) << dof.name;
        if (dof.closing == 0) {
          EXPECT_EQ(way, 0) << dof.name;
        }
      }
      if (dof.closing == 0) continue;
      const double range = dof.upper - dof.lower;
      EXPECT_GT((together[k] - scheme.open.robot[k]) * dof.closing, 0.3 * range) << dof.name;
      EXPECT_LE(together[k], dof.upper + 1e-9) << dof.name;
      EXPECT_GE(together[k], dof.lower - 1e-9) << dof.name;
    }
  }
}

/// m, from the thumb's tip to the middle of the others.
double gap_at(const model::HandModel& hand, const VectorXd& dof) {
  const auto driver = drivers(hand);
  const auto tips = hand.fingertip_positions(dof);
  Eigen::Vector3d thumb = Eigen::Vector3d::Zero(), others = thumb;
  for (std::size_t f = 0; f < tips.size(); ++f)
    if (driver[f] == Driver::thumb)
      thumb = tips[f];
    else
      others += tips[f] / static_cast<double>(tips.size() - 1);
  return (thumb - others).norm();
}

double open_gap(const model::HandModel& hand, const Scheme& scheme) {
  return gap_at(hand, scheme.open.robot);
}

/// When all, or all but the thumb, have begun to close. Later fingers have passed a thumb that
/// stands out of the palm.
double gap(const model::HandModel& hand, const Scheme& scheme, bool thumb_too) {
  constexpr double share = 0.2;
  VectorXd dof = scheme.open.robot;
  for (const SchemePosture& closed : scheme.closed)
    if (thumb_too || closed.name != "thumb") dof += share * (closed.robot - scheme.open.robot);
  return gap_at(hand, dof);
}

// The sense is right in space, not only by hand.toml: a thumb that closes comes nearer to the
// fingers that close than one that stays open.
TEST_F(EveryHand, ThumbClosesTowardsTheFingers) {
  for (const model::HandModel& hand : hands()) {
    SCOPED_TRACE(hand.name());
    const auto driver = drivers(hand);
    EXPECT_EQ(std::count(driver.begin(), driver.end(), Driver::thumb), 1);
    EXPECT_GE(std::count(driver.begin(), driver.end(), Driver::index), 1);
    const Scheme scheme = derive_scheme(hand);
    // Where one motor closes all fingers alike, the thumb does so by its part of the same way.
    if (hand.name().find("motors of all") != std::string::npos)
      EXPECT_LT(gap(hand, scheme, true), open_gap(hand, scheme) - 0.004);
    else
      EXPECT_LT(gap(hand, scheme, true), gap(hand, scheme, false) - 0.004);
  }
}

TEST_F(EveryHand, HasPreshapesForAllGraspsWithinItsLimits) {
  for (const model::HandModel& hand : hands()) {
    SCOPED_TRACE(hand.name());
    const Scheme scheme = derive_scheme(hand);
    for (const GraspType type : grasp_types)
      EXPECT_TRUE(std::any_of(scheme.preshapes.begin(), scheme.preshapes.end(), [&](const auto& p) {
        return std::find(p.types.begin(), p.types.end(), type) != p.types.end();
      })) << to_string(type);
    std::vector<VectorXd> postures{scheme.open.robot};
    for (const Preshape& preshape : scheme.preshapes) {
      postures.push_back(preshape.robot);
      ASSERT_EQ(preshape.resting.size(), hand.dofs().size());
      // Something closes against something.
      EXPECT_NE(preshape.resting, std::vector<bool>(hand.dofs().size(), true));
    }
    for (const SchemePosture& closed : scheme.closed) postures.push_back(closed.robot);
    for (const VectorXd& posture : postures) {
      EXPECT_GE((posture - scheme.lower).minCoeff(), -1e-9);
      EXPECT_GE((scheme.upper - posture).minCoeff(), -1e-9);
    }
  }
}

std::vector<std::string> driven_by(const model::HandModel& hand, Driver wanted) {
  std::vector<std::string> names;
  const auto driver = drivers(hand);
  for (std::size_t f = 0; f < driver.size(); ++f)
    if (driver[f] == wanted) names.push_back(hand.fingertips()[f].name);
  return names;
}

using Names = std::vector<std::string>;

TEST(Drivers, AreFoundWhereNobodySaysThem) {
  EXPECT_EQ(driven_by(untold("barrett"), Driver::thumb), Names{"finger 3"});
  for (const char* name : {"dlr", "robonaut", "rutgers", "human"}) {
    EXPECT_EQ(driven_by(untold(name), Driver::thumb), Names{"thumb"}) << name;
    EXPECT_EQ(driven_by(untold(name), Driver::index), Names{"index"}) << name;
  }
}

TEST(Drivers, AreAsHandTomlSaysThem) {
  EXPECT_EQ(driven_by(test::hand("barrett"), Driver::index), (Names{"finger 1", "finger 2"}));
  EXPECT_EQ(driven_by(test::hand("dlr"), Driver::little), (Names{"middle", "ring"}));
}

TEST(Drivers, OfImportedHands) {
  for (const auto& popular : popular_hands::popular_hands()) {
    const model::HandModel hand = imported(popular);
    const auto thumb = driven_by(hand, Driver::thumb), index = driven_by(hand, Driver::index);
    ASSERT_EQ(thumb.size(), 1u) << popular.name;
    // Jaws, and fingers around a palm: any of them may be the thumb.
    if (popular.urdf.find("\"thumb") == std::string::npos) continue;
    EXPECT_TRUE(thumb.front().starts_with("thumb")) << popular.name << ": " << thumb.front();
    if (popular.name == "adaptive") continue;  // left or right
    ASSERT_EQ(index.size(), 1u) << popular.name;
    EXPECT_TRUE(index.front().starts_with("index") || index.front().starts_with("first") ||
                index.front().starts_with("finger0"))
        << popular.name << ": " << index.front();
  }
}

/// Those with a thumb, of more than two fingers: of two, either may be the thumb.
std::vector<test::MadeHand> hands_with_thumbs() {
  std::vector<test::MadeHand> hands;
  for (const test::MadeHand& made : test::made_hands())
    if (made.thumb && made.fingers > 2) hands.push_back(made);
  return hands;
}

TEST(MadeHands, HaveOneDofTo25) {
  std::set<std::size_t> dofs;
  for (const test::MadeHand& made : test::made_hands())
    dofs.insert(test::made_hand(made).dofs().size());
  EXPECT_EQ(*dofs.begin(), 1u);
  EXPECT_EQ(*dofs.rbegin(), 25u);
}

TEST(MadeHands, ThumbAndTheFingerNextToItAreFound) {
  for (const test::MadeHand& made : hands_with_thumbs()) {
    SCOPED_TRACE(made.name());
    const model::HandModel hand = test::made_hand(made);
    EXPECT_EQ(driven_by(hand, Driver::thumb), Names{"thumb"});
    EXPECT_EQ(driven_by(hand, Driver::index), Names{"1"});
    EXPECT_EQ(driven_by(hand, Driver::little).size(), hand.fingertips().size() - 2);
  }
}

// Who wrote the URDF may have begun with any finger.
TEST(MadeHands, OrderOfFingertipsSaysNothing) {
  for (test::MadeHand made : hands_with_thumbs()) {
    SCOPED_TRACE(made.name());
    const model::HandModel forwards = test::made_hand(made);
    made.backwards = true;
    const model::HandModel backwards = test::made_hand(made);
    for (const Driver driver : {Driver::thumb, Driver::index, Driver::little}) {
      Names one = driven_by(forwards, driver), other = driven_by(backwards, driver);
      std::sort(one.begin(), one.end());
      std::sort(other.begin(), other.end());
      EXPECT_EQ(one, other);
    }
  }
}

TEST(MadeHands, LeftOnesCloseAsRightOnes) {
  for (test::MadeHand made : hands_with_thumbs()) {
    if (made.left) continue;
    SCOPED_TRACE(made.name());
    const Scheme right = derive_scheme(test::made_hand(made));
    made.left = true;
    const Scheme left = derive_scheme(test::made_hand(made));
    ASSERT_EQ(left.closed.size(), right.closed.size());
    for (std::size_t i = 0; i < left.closed.size(); ++i) {
      EXPECT_EQ(left.closed[i].human, right.closed[i].human);
      EXPECT_TRUE(left.closed[i].robot.isApprox(right.closed[i].robot, 1e-9));
    }
  }
}

// One motor for both jaws: thumb and index finger do half of the way each.
TEST(DerivedScheme, SharesAMotorThatMovesSeveralFingers) {
  const model::HandModel jaw = test::hand("parallel_jaw");
  const Scheme scheme = derive_scheme(jaw);
  const double open = jaw.postures().at("open")[0];
  EXPECT_NEAR(scheme.closed[0].robot[0], open / 2, 1e-12);
  EXPECT_NEAR(scheme.closed[1].robot[0], open / 2, 1e-12);
  EXPECT_NEAR(scheme.closed[2].robot[0], open, 1e-12);
}

// A posture that is a fist is no beginning of a grasp.
TEST(DerivedScheme, DoesNotBeginClosed) {
  const model::HandModel jaw = test::hand("parallel_jaw");
  ASSERT_TRUE(jaw.postures().contains("closed"));
  for (const Preshape& preshape : derive_scheme(jaw).preshapes)
    EXPECT_GT(preshape.robot[0], jaw.postures().at("closed")[0] + 0.01);
}

TEST(DerivedScheme, IsUsedOnlyWhereThereIsNoFile) {
  const auto written = load_or_derive(test::in_sources("services/mapping/schemes/barrett.toml"),
                                      test::hand("barrett"));
  ASSERT_TRUE(written) << written.error().message();
  EXPECT_EQ(written->name, "barrett alternative 2");
  const auto derived = load_or_derive("/nowhere/scheme.toml", test::hand("barrett"));
  ASSERT_TRUE(derived);
  EXPECT_EQ(derived->name, "barrett, derived");
  const auto bad = std::filesystem::path(testing::TempDir()) / "prehend_derived_scheme.toml";
  std::ofstream(bad) << "hand = \"dlr\"\n";
  EXPECT_FALSE(load_or_derive(bad, test::hand("barrett")));  // refused, not passed over
  std::filesystem::remove(bad);
}

}  // namespace
}  // namespace prehend::mapping
