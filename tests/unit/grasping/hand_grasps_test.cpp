// Each hand, closed from a named preshape on an object that stands at its grasp frame, has it by at
// least two contacts and still has it after lifting: its shapes, torques, closing signs and grasp
// frame fit together. The world is deterministic, so a grasp that is found once is found always.
#include <gtest/gtest.h>

#include "common/grasping/closing.hpp"
#include "common/model/catalogue.hpp"
#include "tests/support/paths/paths.hpp"

namespace {

using namespace prehend;
using namespace prehend::grasping;
using Eigen::Matrix3d;
using Eigen::Vector3d;

struct Trial {
  const char* hand;
  const char* object;
  const char* posture;
  bool across;   // the object's z along x of the grasp frame; otherwise against its z
  double ahead;  // m, of the object's middle before the grasp frame
};

void PrintTo(const Trial& trial, std::ostream* out) {
  *out << trial.hand << " on " << trial.object;
}

class HandGrasps : public testing::TestWithParam<Trial> {};

TEST_P(HandGrasps, HoldWhatStandsAtTheGraspFrame) {
  const Trial& trial = GetParam();
  const std::string models = test::in_sources("common/models/");
  const auto hand = model::HandModel::load(models + "hands/" + trial.hand);
  ASSERT_TRUE(hand) << hand.error().message();
  const auto catalogue = model::Catalogue::load(models + "objects/catalogue.toml");
  ASSERT_TRUE(catalogue) << catalogue.error().message();
  const model::CatalogueObject* object = catalogue->find(trial.object);
  ASSERT_TRUE(object);

  Matrix3d R_GO = Matrix3d(Eigen::AngleAxisd(EIGEN_PI, Vector3d::UnitX()));
  if (trial.across) R_GO = Matrix3d(Eigen::AngleAxisd(EIGEN_PI / 2, Vector3d::UnitY()));
  ClosingOptions options;
  options.hold_test = HoldOptions{};
  options.down_B = hand->X_BG().linear() * R_GO * -Vector3d::UnitZ();
  const auto grasp =
      close_hand(*hand, {object->name, object->shape, object->mass, object->material, {}},
                 hand->X_BG() * make_pose(Vector3d(0, 0, trial.ahead), R_GO),
                 hand->postures().at(trial.posture), options);
  ASSERT_TRUE(grasp) << grasp.error().message();
  EXPECT_GE(grasp->contacts.size(), 2u);
  for (Eigen::Index i = 0; i < grasp->joints.size(); ++i) {
    const auto& joint = hand->joints()[static_cast<std::size_t>(i)];
    EXPECT_GT(grasp->joints[i], joint.lower - 0.02) << joint.name;
    EXPECT_LT(grasp->joints[i], joint.upper + 0.02) << joint.name;
  }
  ASSERT_TRUE(grasp->hold);
  EXPECT_TRUE(grasp->hold->held) << grasp->hold->reason;
}

INSTANTIATE_TEST_SUITE_P(All, HandGrasps,
                         testing::Values(Trial{"barrett", "Talc", "open", true, 0.0},
                                         Trial{"dlr", "Talc", "power", true, 0.026},
                                         Trial{"robonaut", "Talc", "power", true, -0.01},
                                         Trial{"human", "Talc", "power", true, 0.01},
                                         Trial{"parallel_jaw", "Talc", "open", true, 0.0},
                                         Trial{"parallel_jaw", "Wood cube", "open", false, 0.0}));

}  // namespace
