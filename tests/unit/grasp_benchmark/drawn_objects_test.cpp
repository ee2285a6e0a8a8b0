// Objects to be judged with that nobody has trained with: of all shapes, sound, the same for a
// seed.
#include "services/mapping/tools/judging/drawn_objects.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "common/analysis/materials.hpp"

namespace prehend::mapping {
namespace {

TEST(DrawnObjects, AreSoundOfAllShapesAndTheSameForASeed) {
  const model::Catalogue drawn = drawn_objects(400, 7), again = drawn_objects(400, 7);
  std::map<model::ShapeKind, int> kinds;
  std::set<std::string> names;
  for (std::size_t i = 0; i < drawn.objects().size(); ++i) {
    const model::CatalogueObject& object = drawn.objects()[i];
    EXPECT_TRUE(is_valid(object.shape));
    EXPECT_TRUE(analysis::material_from_string(object.material)) << object.material;
    const Eigen::Vector3d half = half_extents(object.shape);
    EXPECT_GE(half.minCoeff(), 0.005 - 1e-9);
    EXPECT_LE(2 * half.head<2>().minCoeff(), 0.09 + 1e-9);
    EXPECT_GE(object.mass, 0.03);
    EXPECT_LE(object.mass, 0.6);
    EXPECT_EQ(object.shape, again.objects()[i].shape);
    ++kinds[object.shape.kind];
    names.insert(object.name);
  }
  EXPECT_EQ(names.size(), 400u);
  EXPECT_EQ(kinds.size(), 4u);
  for (const auto& [kind, count] : kinds) EXPECT_GT(count, 60) << to_string(kind);
  EXPECT_NE(drawn_objects(1, 8).objects()[0].shape, drawn.objects()[0].shape);
}

}  // namespace
}  // namespace prehend::mapping
