#include "services/demonstration/core/recognition/distribution.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/random.hpp"

namespace prehend::demonstration {
namespace {

TEST(Distribution, ScoresBecomeProbabilitiesWhateverTheirSize) {
  const Eigen::Vector3d scores(1, 2, 4);
  const Distribution p = distribution_of(scores, 2);
  EXPECT_NEAR(p.sum(), 1, 1e-12);
  EXPECT_NEAR(p[2] / p[0], std::exp(1.5), 1e-12);
  EXPECT_TRUE(p.isApprox(distribution_of((scores.array() + 1e5).matrix(), 2), 1e-9));
  EXPECT_TRUE(distribution_of(Eigen::Vector2d(-1e308, 1e308), 1).allFinite());
}

// The cup of the thesis, figure 3.6: the object leaves three grasps, the task two of these.
TEST(Distribution, ObjectAndTaskNarrowTheAnswer) {
  const Distribution seen = Eigen::Vector4d(0.4, 0.3, 0.2, 0.1);  // sphere, hook, wrap, precision
  const auto of_object = with_prior(seen, Eigen::Vector4d(1, 0, 1, 1));
  ASSERT_TRUE(of_object);
  EXPECT_TRUE(of_object->isApprox(Eigen::Vector4d(4, 0, 2, 1) / 7, 1e-12));
  const auto of_task = with_prior(*of_object, Eigen::Vector4d(0, 1, 1, 1));
  ASSERT_TRUE(of_task);
  EXPECT_TRUE(of_task->isApprox(Eigen::Vector4d(0, 0, 2, 1) / 3, 1e-12));
  const auto together = with_prior(seen, Eigen::Vector4d(0, 0, 1, 1));
  EXPECT_TRUE(of_task->isApprox(*together, 1e-12)) << "the order does not matter";
}

TEST(Distribution, APriorThatLeavesNothingIsRefused) {
  const Distribution seen = Eigen::Vector3d(1, 0, 0);
  EXPECT_FALSE(with_prior(seen, Eigen::Vector3d(0, 1, 1)));
  EXPECT_FALSE(with_prior(seen, Eigen::Vector3d(0, 0, 0)));
  EXPECT_FALSE(with_prior(seen, Eigen::Vector3d(1, -1, 1)));
  EXPECT_FALSE(with_prior(seen, Eigen::Vector3d(1, std::nan(""), 1)));
  EXPECT_FALSE(with_prior(seen, Eigen::Vector2d(1, 1)));
}

TEST(Distribution, UnknownBelowTheThreshold) {
  const Distribution p = Eigen::Vector3d(0.2, 0.5, 0.3);
  EXPECT_EQ(decide(p, 0.5).best, 1);
  EXPECT_FALSE(decide(p, 0.51).best);
  EXPECT_DOUBLE_EQ(decide(p, 0.51).probability, 0.5);
}

// Answers that are drawn with the probabilities they say, but whose scores are told three times as
// large: the temperature must undo just that.
TEST(Distribution, CalibrationFindsByHowMuchScoresExaggerate) {
  Random random(1);
  constexpr int count = 20000;
  Eigen::MatrixXd scores(3, count);
  Eigen::VectorXi truths(count);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d honest(random.normal(), random.normal(), random.normal());
    const Distribution p = distribution_of(honest, 1);
    const double u = random.uniform();
    truths[i] = u < p[0] ? 0 : u < p[0] + p[1] ? 1 : 2;
    scores.col(i) = 3 * honest;
  }
  // The standard error of the temperature is about 1 % with so many.
  EXPECT_NEAR(calibrated_temperature(scores, truths), 3, 0.15);
  EXPECT_EQ(calibrated_temperature(Eigen::MatrixXd(3, 0), Eigen::VectorXi(0)), 1);
}

}  // namespace
}  // namespace prehend::demonstration
