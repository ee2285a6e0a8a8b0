// Training sets: what is refused, and that a file brings back what was saved.
#include "common/learning/training_set.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "common/proto/training_set.pb.h"

namespace prehend::learning {
namespace {

TrainingSet small_set() {
  TrainingSet set{"barrett", "a scheme", {"spread", "finger"}, {}};
  TrainingPair pair;
  pair.features = Eigen::Vector3d(0.1, 0.2, 0.3);
  pair.dof = Eigen::Vector2d(0, 1);
  pair.user = "anna";
  pair.take = 2;
  pair.posture = "open";
  pair.source = "synthetic";
  set.pairs.push_back(pair);
  pair.posture = "power wrap";
  pair.object = "Talc";
  pair.shape = "cylinder";
  pair.size = {0.024, 0.024, 0.105};
  set.pairs.push_back(pair);
  return set;
}

TEST(TrainingSet, ComesBackFromItsFile) {
  const auto file = std::filesystem::path(testing::TempDir()) / "prehend_training_set_test";
  ASSERT_TRUE(save(file, small_set()));
  const auto loaded = load_training_set(file);
  ASSERT_TRUE(loaded) << loaded.error().message();
  EXPECT_EQ(serialise(*loaded), serialise(small_set()));
  EXPECT_EQ(loaded->pairs[1].size, small_set().pairs[1].size);
  EXPECT_EQ(loaded->pairs[1].object, "Talc");
  std::filesystem::remove(file);
  EXPECT_FALSE(load_training_set(file));
}

TEST(TrainingSet, RefusesWhatCannotBeTrained) {
  EXPECT_TRUE(check(small_set()));
  TrainingSet set = small_set();
  set.pairs[1].posture = "open";
  EXPECT_FALSE(check(set)) << "one posture only";
  set = small_set();
  set.pairs[1].dof = Eigen::Vector3d(0, 0, 0);
  EXPECT_FALSE(check(set)) << "wrong number of DoF";
  set = small_set();
  set.pairs[1].features[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(check(set)) << "not a number";
  set = small_set();
  set.pairs[1].features = Eigen::VectorXd::Zero(4);
  EXPECT_FALSE(check(set)) << "different features";
  set = small_set();
  set.hand.clear();
  EXPECT_EQ(check(set).error().what, "a training set names no hand");
  messages::TrainingSet odd;
  odd.add_pairs()->add_size(0.1);
  EXPECT_EQ(parse_training_set(odd.SerializeAsString()).error().what,
            "an object's size is not three numbers");
}

}  // namespace
}  // namespace prehend::learning
