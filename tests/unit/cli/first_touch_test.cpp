// Where an open hand touches a crate first: there it does, a little before it does not, and that
// much further it is in it; of every hand.
#include "services/cli/tools/demo/first_touch.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/grasping/world.hpp"

namespace prehend::cli {
namespace {

using Eigen::Vector3d;

const model::Shape crate{model::ShapeKind::box, {0.3, 0.25, 0.24}};
constexpr double above = 0.03, far = 0.1;  // m

/// Between the crate and a hand whose grasp frame is so far below the surface, m.
double room(const model::HandModel& hand, double below) {
  const Pose X_OG = make_pose(Vector3d(0.15 - below, 0, above),
                              model::grasp_axes(-Vector3d::UnitX(), Vector3d::UnitY()));
  auto world = grasping::World::create(hand, X_OG * hand.X_BG().inverse(),
                                       hand.postures().at("open"), {.table = false});
  if (!world || !(*world)->add_body({.name = "crate", .shape = crate}, Pose::Identity())) return -1;
  return (*world)->distance_to_hand(0, far);
}

TEST(FirstTouch, OfEveryHandIsWhereItTouches) {
  for (const std::string& name : model::hand_names()) {
    SCOPED_TRACE(name);
    const auto hand = model::HandModel::load(model::hand_directory(name));
    ASSERT_TRUE(hand) << hand.error().message();
    const double touched = first_touch(*hand, crate, above);
    ASSERT_TRUE(std::isfinite(touched));
    EXPECT_NEAR(room(*hand, touched), 0, 2e-3);
    EXPECT_GT(room(*hand, touched - 0.01), 5e-3);
    EXPECT_LT(room(*hand, touched + 0.01), -1e-3);
  }
}

TEST(FirstTouch, OfWhatIsPassedByIsNone) {
  const auto hand = model::HandModel::load(model::hand_directory(model::lab_hand()));
  ASSERT_TRUE(hand);
  EXPECT_FALSE(std::isfinite(first_touch(*hand, crate, 3.0)));
}

}  // namespace
}  // namespace prehend::cli
