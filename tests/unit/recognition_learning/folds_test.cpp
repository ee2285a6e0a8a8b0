// Folds: pictures before one background must not be parted, whatever their order; Ward's method
// must find clusters that are far apart compared with their width.
#include "services/recognition/core/learning/folds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "tests/unit/recognition_learning/painted.hpp"

namespace prehend::recognition {
namespace {

TEST(Ward, FindsClustersThatAreFarApart) {
  Random random(1);
  Eigen::MatrixXf columns(2, 60);
  for (Eigen::Index i = 0; i < 60; ++i) {
    columns(0, i) = static_cast<float>(10 * (i % 3) + random.uniform(-1, 1));
    columns(1, i) = static_cast<float>(random.uniform(-1, 1));
  }
  const std::vector<int> found = ward(columns, 3);
  for (std::size_t i = 0; i < 60; ++i)
    for (std::size_t j = 0; j < 60; ++j) EXPECT_EQ(found[i] == found[j], i % 3 == j % 3);
}

TEST(Ward, HasNoMoreClustersThanColumns) {
  EXPECT_EQ(ward(Eigen::MatrixXf::Zero(3, 2), 5).size(), 2u);
  EXPECT_TRUE(ward(Eigen::MatrixXf::Zero(3, 0), 5).empty());
}

TEST(Folds, PicturesBeforeOneBackgroundStayTogether) {
  std::vector<TrainingClass> classes = painted_classes(5, 3);
  // Shuffled, so that neither order nor numbers help.
  std::vector<std::vector<std::size_t>> background;
  Random random(4);
  for (TrainingClass& c : classes) {
    background.emplace_back();
    for (std::size_t i = 0; i < c.views.size(); ++i) background.back().push_back(i / 3);
    for (std::size_t i = c.views.size(); i-- > 1;) {
      const std::size_t j = random.index(i + 1);
      std::swap(c.views[i], c.views[j]);
      std::swap(background.back()[i], background.back()[j]);
    }
  }
  const std::vector<int> fold = folds_by_background(classes, 5);
  std::size_t at = 0;
  for (std::size_t c = 0; c < classes.size(); ++c) {
    std::map<std::size_t, std::set<int>> folds_of;
    for (const std::size_t b : background[c]) folds_of[b].insert(fold[at++]);
    std::set<int> used;
    for (const auto& [b, folds] : folds_of) {
      EXPECT_EQ(folds.size(), 1u) << "class " << c << " background " << b;
      used.insert(*folds.begin());
    }
    EXPECT_EQ(used.size(), 5u);  // as many groups as folds: one each
  }
}

TEST(Folds, FewViewsAreSpreadAndNoneIsNoTrouble) {
  std::vector<TrainingClass> classes = painted_classes(1, 5);
  classes[0].views.resize(1);
  classes[1].views.clear();
  const std::vector<int> fold = folds_by_background(classes, 5);
  EXPECT_EQ(fold.size(), 4u);
  for (const int f : fold) {
    EXPECT_GE(f, 0);
    EXPECT_LT(f, 5);
  }
}

}  // namespace
}  // namespace prehend::recognition
