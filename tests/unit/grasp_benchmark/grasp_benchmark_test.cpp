// The benchmark's own promises, on the Barrett hand: a seed makes the take, takes are the same for
// all modes and stay within the errors that are drawn, and the results do not depend on how the
// work is divided. Everything is deterministic, so equality is exact; tolerances are those of the
// errors' definitions.
#include "services/mapping/tools/judging/grasp_benchmark.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>

#include "services/mapping/files/mapping_model_file.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::mapping {
namespace {

template <class T>
T loaded(Expected<T> value) {
  if (!value) throw std::runtime_error(value.error().message());
  return std::move(*value);
}

const model::HandModel& barrett() {
  static const auto hand =
      loaded(model::HandModel::load(test::in_sources("common/models/hands/barrett")));
  return hand;
}

const std::vector<RobotGrasp>& grasps() {
  static const auto grasps =
      loaded(load_robot_grasps(test::in_share("trained/barrett.grasps"), barrett()));
  return grasps;
}

Expected<std::vector<TrialResult>> run(const GraspBenchmarkOptions& options,
                                       const grasping::ForEach& for_each) {
  static const auto model =
      loaded(load_mapping_model(test::in_share("trained/barrett.mapping"), barrett()));
  static const auto catalogue =
      loaded(model::Catalogue::load(test::in_sources("common/models/objects/catalogue.toml")));
  static const auto objects = loaded(grasping::CatalogueBodies::create(catalogue));
  return run_grasp_benchmark({barrett(), model, grasps(), objects}, options, for_each);
}

void in_order(std::size_t count, const std::function<void(std::size_t)>& work) {
  for (std::size_t i = 0; i < count; ++i) work(i);
}

void backwards_in_threads(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::vector<std::jthread> threads;
  for (std::size_t i = count; i-- > 0;) threads.emplace_back([&work, i] { work(i); });
}

TEST(GraspBenchmark, NeedsTheObjectsOfItsGrasps) {
  auto odd = grasps();
  for (RobotGrasp& grasp : odd) grasp.object = "Teapot";
  const auto model =
      loaded(load_mapping_model(test::in_share("trained/barrett.mapping"), barrett()));
  const auto objects = loaded(grasping::CatalogueBodies::create(model::Catalogue()));
  const auto results = run_grasp_benchmark({barrett(), model, odd, objects}, {}, in_order);
  ASSERT_FALSE(results);
  EXPECT_EQ(results.error().message(), "Teapot: is not in the catalogue");
}

TEST(RecordedTake, FollowsFromItsSeed) {
  const RobotGrasp& grasp = grasps().front();
  const auto one = record_take(grasp, 5, {}), same = record_take(grasp, 5, {}),
             other = record_take(grasp, 6, {});
  ASSERT_TRUE(one && same && other);
  ASSERT_EQ(one->postures.size(), same->postures.size());
  for (std::size_t k = 0; k < one->postures.size(); ++k) {
    EXPECT_EQ(one->postures[k].X_WH.matrix(), same->postures[k].X_WH.matrix());
    EXPECT_EQ(one->postures[k].fingertips[1].p_HF, same->postures[k].fingertips[1].p_HF);
  }
  EXPECT_NE(one->closure, other->closure);
}

TEST(RecordedTake, ReachesWithinTheErrorsThatAreDrawn) {
  const TakeOptions options{.size_error = 0.2, .position_error = 0.01};
  double squares = 0;
  int takes = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const RobotGrasp& grasp = grasps()[seed % grasps().size()];
    const auto take = record_take(grasp, seed, options);
    if (!take) continue;
    const Pose X_GG = (take->X_WO * grasp.X_OG).inverse() * take->X_WG;
    EXPECT_LE(X_GG.translation().cwiseAbs().maxCoeff(), options.demonstrator.approach);
    EXPECT_LE(angle_between(X_GG.linear(), Eigen::Matrix3d::Identity()),
              options.demonstrator.approach_turn + 1e-9);
    EXPECT_NEAR(std::abs(take->seen_shape.size.x() / grasp.shape.size.x() - 1), 0.2, 1e-9);
    EXPECT_EQ(take->covariance(0, 0), 1e-4);
    squares += take->X_OS.translation().head<2>().squaredNorm();
    ++takes;
  }
  ASSERT_GT(takes, 40);
  // Mean of 2 · takes squares of sigma 1 cm: its own deviation is 1 / sqrt(takes) of it.
  EXPECT_NEAR(squares / (2 * takes), 1e-4, 4e-4 / std::sqrt(takes));
}

TEST(GraspBenchmark, GivesAllModesTheSameTakesHoweverTheWorkIsDivided) {
  GraspBenchmarkOptions options;
  options.takes = first_takes(2);
  const auto results = run(options, in_order);
  ASSERT_TRUE(results) << results.error().message();
  ASSERT_EQ(results->size(), 4u);
  for (int take = 0; take < 2; ++take) {
    const TrialResult &direct = (*results)[2 * take], &intelligent = (*results)[2 * take + 1];
    EXPECT_EQ(direct.mode.mode, BenchmarkMode::direct);
    EXPECT_EQ(intelligent.mode.mode, BenchmarkMode::intelligent);
    for (const TrialResult* result : {&direct, &intelligent}) {
      EXPECT_EQ(result->take, take);
      EXPECT_EQ(result->user, direct.user);
      EXPECT_EQ(result->object, grasps()[static_cast<std::size_t>(take)].object);
      EXPECT_TRUE(std::isfinite(result->joint_error) && std::isfinite(result->fingertip_error));
      EXPECT_EQ(result->held, result->reason.empty());
    }
  }
  const auto again = run(options, backwards_in_threads);
  ASSERT_TRUE(again);
  for (std::size_t i = 0; i < results->size(); ++i) {
    EXPECT_EQ((*results)[i].held, (*again)[i].held);
    EXPECT_EQ((*results)[i].joint_error, (*again)[i].joint_error);
    EXPECT_EQ((*results)[i].fingertip_error, (*again)[i].fingertip_error);
    EXPECT_EQ((*results)[i].epsilon, (*again)[i].epsilon);
  }
}

TEST(GraspBenchmark, SaysWhenThereIsNothingToRepeat) {
  const std::vector<RobotGrasp> none;
  const auto model =
      loaded(load_mapping_model(test::in_share("trained/barrett.mapping"), barrett()));
  const grasping::CatalogueBodies objects;
  const auto results = run_grasp_benchmark({barrett(), model, none, objects}, {}, in_order);
  ASSERT_FALSE(results);
  EXPECT_EQ(results.error().where, "barrett");
}

}  // namespace
}  // namespace prehend::mapping
