// Training and evaluating networks. FANN trains, our own forward pass answers: the two must agree.
#include <doublefann.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <prehend/base/random.hpp>
#include <prehend/learning/network.hpp>
#include <prehend/learning/training.hpp>

namespace prehend::learning {
namespace {

Samples exclusive_or() {
  Samples samples;
  samples.inputs.resize(2, 4);
  samples.inputs << -1, -1, 1, 1, -1, 1, -1, 1;
  samples.outputs.resize(1, 4);
  samples.outputs << -0.9, 0.9, 0.9, -0.9;
  return samples;
}

/// A smooth function of three numbers, with noise that an overfitting network would learn.
Samples noisy_function(std::uint64_t seed, int count, double noise) {
  Random random(seed);
  Samples samples{Eigen::MatrixXd(3, count), Eigen::MatrixXd(2, count)};
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d x(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    samples.inputs.col(k) = x;
    samples.outputs(0, k) = 0.6 * std::sin(2 * x[0]) * x[1] + random.normal(noise);
    samples.outputs(1, k) = 0.5 * x[2] * x[2] - 0.3 * x[0] + random.normal(noise);
  }
  return samples;
}

class EveryMethod : public testing::TestWithParam<TrainingMethod> {};

// What no single neuron can do. One set of first weights may be stuck in a local minimum, so the
// best of three counts. 0.05: far from the sign change at 0.9, reached by every method.
TEST_P(EveryMethod, LearnsExclusiveOr) {
  TrainingOptions options;
  options.method = GetParam();
  options.hidden = 4;
  options.epochs = options.patience = 5000;
  options.learning_rate = 0.1;  // 0.7 throws incremental training about
  const Samples samples = exclusive_or();
  double best = 1e9;
  for (options.seed = 1; options.seed <= 3; ++options.seed) {
    const auto result = train(samples, {}, options);
    ASSERT_TRUE(result) << result.error().message();
    if (result->training_error >= best) continue;
    best = result->training_error;
    for (int k = 0; best < 0.05 && k < 4; ++k)
      EXPECT_EQ(std::signbit(result->network.evaluate(samples.inputs.col(k))[0]),
                std::signbit(samples.outputs(0, k)));
  }
  EXPECT_LT(best, 0.05);
}

// Bit for bit: no tolerance.
TEST_P(EveryMethod, RepeatsBitForBitAndFollowsTheSeed) {
  TrainingOptions options;
  options.method = GetParam();
  options.epochs = 50;
  const Samples samples = noisy_function(1, 40, 0.05);
  const auto first = train(samples, {}, options);
  const auto again = train(samples, {}, options);
  options.seed = 2;
  const auto other = train(samples, {}, options);
  ASSERT_TRUE(first && again && other);
  for (std::size_t i = 0; i < first->network.layers().size(); ++i) {
    EXPECT_EQ(first->network.layers()[i], again->network.layers()[i]);
    EXPECT_NE(first->network.layers()[i], other->network.layers()[i]);
  }
}

TEST_P(EveryMethod, IsKnownByName) {
  EXPECT_EQ(method_from_string(to_string(GetParam())), GetParam());
}

INSTANTIATE_TEST_SUITE_P(Training, EveryMethod,
                         testing::Values(TrainingMethod::incremental, TrainingMethod::batch,
                                         TrainingMethod::rprop, TrainingMethod::quickprop,
                                         TrainingMethod::sarprop),
                         [](const auto& method) { return std::string(to_string(method.param)); });

// The same weights in fann_run: differences only by the order of summation, a few ulp.
TEST(Network, EqualsFann) {
  Random random(7);
  std::vector<Layer> layers{Layer(10, 13), Layer(4, 11)};
  fann* theirs = fann_create_standard(3, 12, 10, 4);
  ASSERT_NE(theirs, nullptr);
  fann_set_activation_function_hidden(theirs, FANN_SIGMOID_SYMMETRIC);
  fann_set_activation_function_output(theirs, FANN_SIGMOID_SYMMETRIC);
  fann_type* weight = theirs->weights;
  for (Layer& layer : layers)
    for (Eigen::Index row = 0; row < layer.rows(); ++row)
      for (Eigen::Index col = 0; col < layer.cols(); ++col)
        *weight++ = layer(row, col) = random.normal(0.8);
  ASSERT_EQ(weight - theirs->weights, fann_get_total_connections(theirs));
  const auto ours = Network::create(layers);
  ASSERT_TRUE(ours);
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::VectorXd x(12);
    for (double& value : x) value = random.uniform(-1.5, 1.5);
    const fann_type* expected = fann_run(theirs, x.data());
    const Eigen::VectorXd y = ours->evaluate(x);
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(y[i], expected[i], 1e-13);
  }
  fann_destroy(theirs);
}

TEST(Network, RefusesWhatDoesNotFit) {
  EXPECT_FALSE(Network::create({}));
  EXPECT_FALSE(Network::create({Layer::Zero(3, 4), Layer::Zero(2, 3)}));
  EXPECT_FALSE(Network::create({Layer::Zero(0, 4)}));
  Layer layer = Layer::Zero(2, 3);
  layer(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Network::create({layer}));
}

// With far more neurons than the noise deserves the training error keeps falling while the
// validation error rises: training must stop before its last epoch and keep the best network.
TEST(Training, StopsEarlyOnTheValidationError) {
  const Samples training = noisy_function(1, 30, 0.2), validation = noisy_function(2, 200, 0.2);
  TrainingOptions options;
  options.hidden = 20;
  options.epochs = 5000;
  const auto stopped = train(training, validation, options);
  const auto overfitted = train(training, {}, options);
  ASSERT_TRUE(stopped && overfitted);
  EXPECT_LT(stopped->epochs, options.epochs);
  EXPECT_DOUBLE_EQ(stopped->validation_error, squared_error(stopped->network, validation));
  EXPECT_LT(overfitted->training_error, stopped->training_error);
  EXPECT_LT(stopped->validation_error, 0.8 * squared_error(overfitted->network, validation));
}

TEST(Training, RefusesBadSamples) {
  Samples samples = exclusive_or();
  samples.inputs(0, 1) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(train(samples, {}, {}));
  samples = exclusive_or();
  samples.outputs.conservativeResize(1, 3);
  EXPECT_FALSE(train(samples, {}, {}));
  EXPECT_FALSE(train({}, {}, {}));
  EXPECT_FALSE(train(exclusive_or(), noisy_function(1, 3, 0), {}));
}

}  // namespace
}  // namespace prehend::learning
