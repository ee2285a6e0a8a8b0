// Soft fingers: rubber bears a moment about the normal, everything else touches in a point, and the
// contacts that the world reports carry the same coefficients that it solves with.
#include <gtest/gtest.h>

#include "common/analysis/materials.hpp"
#include "common/grasping/world.hpp"
#include "tests/support/hands.hpp"

namespace {

using namespace prehend;
using namespace prehend::grasping;
using Eigen::Vector3d;
using Eigen::VectorXd;

TEST(SoftFinger, RubberHasTorsionAndNothingElseHas) {
  using analysis::Material;
  for (const Material other : {Material::glass, Material::metal, Material::plastic, Material::wood,
                               Material::rubber, Material::stone}) {
    EXPECT_GT(analysis::torsion(Material::rubber, other), 0);
    EXPECT_EQ(analysis::torsion(Material::rubber, other),
              analysis::torsion(other, Material::rubber));
  }
  EXPECT_EQ(analysis::torsion(Material::metal, Material::wood), 0);
}

TEST(SoftFinger, ContactsInTheWorldCarryWhatTheWorldUses) {
  const model::HandModel& hand = test::hand("barrett");
  auto world = std::move(*World::create(hand, make_pose(Vector3d(0, 0, 1)), VectorXd::Zero(4),
                                        {.table = false, .gravity_W = Vector3d::Zero()}));
  world->set_object_damping(20);
  const Body ball{"ball", {model::ShapeKind::sphere, Vector3d::Constant(0.03)}, 0.1, "wood", {}};
  ASSERT_TRUE(world->add_body(ball, make_pose(Vector3d(0, 0, 1 + 0.07))));
  VectorXd closed(4);
  closed << 0, 1.6, 1.6, 1.6;
  ASSERT_TRUE(world->command(world->commanded_base(), closed));
  for (int i = 0; i < 800; ++i) world->step();
  const auto contacts = world->contacts(0);
  ASSERT_GE(contacts.size(), 2u);
  for (const analysis::Contact& contact : contacts) {
    const bool pad = contact.link != "palm";
    EXPECT_EQ(contact.torsion, pad ? 0.002 : 0.0) << contact.link;
    EXPECT_EQ(contact.friction, pad ? 1.0 : 0.4) << contact.link;
    EXPECT_GE(contact.depth, 0);
    EXPECT_LT(contact.depth, 0.001);
  }
}

}  // namespace
