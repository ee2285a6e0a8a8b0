// The friction table against figures read from it, and the choice of contacts.
#include "common/analysis/materials.hpp"

#include <gtest/gtest.h>

#include "common/analysis/contact.hpp"

namespace {

using namespace prehend::analysis;

TEST(Materials, FrictionIsSymmetricAndAsTabulated) {
  for (int a = 0; a < 6; ++a)
    for (int b = 0; b < 6; ++b)
      EXPECT_EQ(friction(Material(a), Material(b)), friction(Material(b), Material(a)));
  EXPECT_EQ(friction(Material::rubber, Material::plastic), 1.0);
  EXPECT_EQ(friction(Material::wood, Material::wood), 0.4);
  EXPECT_EQ(friction(Material::rubber, Material::rubber), 2.0);
  EXPECT_EQ(friction(Material::stone, Material::wood), 0.6);
}

TEST(Materials, NamesGoThereAndBack) {
  for (int i = 0; i < 6; ++i) EXPECT_EQ(material_from_string(to_string(Material(i))), Material(i));
  EXPECT_FALSE(material_from_string("jelly"));
}

TEST(Contacts, SpreadKeepsTheStrongestAndTheFarthest) {
  std::vector<Contact> contacts;
  for (int i = 0; i <= 100; ++i)
    contacts.push_back({"", {0.001 * i, 0, 0}, Eigen::Vector3d::UnitZ(), 1, i == 0 ? 5.0 : 1.0, 0});
  const auto chosen = spread_contacts(contacts, 3);
  ASSERT_EQ(chosen.size(), 3u);
  EXPECT_EQ(chosen[0].p_OC.x(), 0);
  EXPECT_EQ(chosen[1].p_OC.x(), 0.1);
  EXPECT_NEAR(chosen[2].p_OC.x(), 0.05, 1e-12);
  EXPECT_TRUE(spread_contacts(contacts, 0).empty());
  EXPECT_EQ(spread_contacts(contacts, 200).size(), contacts.size());
}

}  // namespace
