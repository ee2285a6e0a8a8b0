// Where an open hand is laid against a crate: there it touches, a little before it does not, and
// that much further it is in it; with parts all round the line along which it is pushed; of every
// hand.
#include "services/cli/tools/demo/pressing.hpp"

#include <gtest/gtest.h>

#include "common/base/motion.hpp"
#include "common/grasping/world.hpp"

namespace prehend::cli {
namespace {

using Eigen::Vector3d;

const model::Shape crate{model::ShapeKind::box, {0.3, 0.25, 0.24}};
constexpr double above = 0.03, far = 0.1;  // m

model::HandModel hand_of(const std::string& name) {
  auto hand = model::HandModel::load(model::hand_directory(name));
  if (!hand) throw std::runtime_error(hand.error().message());
  return std::move(*hand);
}

/// Between the crate and a hand, m.
double room(const model::HandModel& hand, const Pose& X_OG, const model::Shape& box = crate) {
  auto world = grasping::World::create(hand, X_OG * hand.X_BG().inverse(),
                                       hand.postures().at("open"), {.table = false});
  if (!world || !(*world)->add_body({.name = "box", .shape = box}, Pose::Identity())) return -1;
  return (*world)->distance_to_hand(0, far);
}

TEST(PressingPose, OfEveryHandIsWhereItTouches) {
  for (const std::string& name : model::hand_names()) {
    SCOPED_TRACE(name);
    const model::HandModel hand = hand_of(name);
    const auto X_OG = pressing_pose(hand, crate, above);
    ASSERT_TRUE(X_OG);
    EXPECT_NEAR(room(hand, *X_OG), 0, 2e-3);
    EXPECT_GT(room(hand, moved(*X_OG, 0.01 * Vector3d::UnitX())), 5e-3);
    EXPECT_LT(room(hand, moved(*X_OG, -0.01 * Vector3d::UnitX())), -1e-3);
    EXPECT_GT(-X_OG->linear()(0, 2), std::cos(0.9));  // the palm still looks at it
  }
}

TEST(PressingPose, PartsOfTheHandAreAllRoundTheLineOfThePush) {
  for (const std::string& name : model::hand_names()) {
    SCOPED_TRACE(name);
    const model::HandModel hand = hand_of(name);
    const auto X_OG = pressing_pose(hand, crate, above);
    ASSERT_TRUE(X_OG);
    if (-X_OG->linear()(0, 2) < std::cos(0.65)) continue;  // turned as far as it may be
    // Half of the crate, on each side of that line, would be touched just as well.
    for (const int axis : {1, 2})
      for (const double side : {-1.0, 1.0}) {
        model::Shape part = crate;
        part.size[axis] = 0.5;
        Pose X_OG_part = moved(*X_OG, Vector3d(-3e-3, 0, -X_OG->translation().z()));
        X_OG_part.pretranslate(-side * 0.25 * Vector3d::Unit(axis));
        EXPECT_LT(room(hand, X_OG_part, part), 0) << axis << " " << side;
      }
  }
}

TEST(PressingPose, OfWhatIsPassedByIsNone) {
  EXPECT_FALSE(pressing_pose(hand_of(model::lab_hand()), crate, 3.0));
}

}  // namespace
}  // namespace prehend::cli
