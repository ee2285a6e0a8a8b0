// Our RPROP against FANN's, from the same first weights on the same samples. Both add the same
// numbers in another order, and a step is doubled or halved by the sign of a sum: 1e-9 after 30
// epochs is what rounding leaves as long as no sum is so near zero that its sign differs.
#include "common/learning/rprop.hpp"

#include <doublefann.h>
#include <gtest/gtest.h>

#include <memory>

#include "common/base/random.hpp"

namespace prehend::learning {
namespace {

/// FANN's weights: neuron by neuron, the bias last.
std::vector<Layer> layers_of(const fann& network, int inputs, int hidden, int outputs) {
  std::vector<Layer> layers{Layer(hidden, inputs + 1), Layer(outputs, hidden + 1)};
  const fann_type* weight = network.weights;
  for (Layer& layer : layers)
    for (Eigen::Index row = 0; row < layer.rows(); ++row)
      for (Eigen::Index col = 0; col < layer.cols(); ++col) layer(row, col) = *weight++;
  return layers;
}

class RpropTest : public testing::TestWithParam<int> {};

TEST_P(RpropTest, IsFannsToRounding) {
  const int pairs = GetParam(), inputs = 5, hidden = 7, outputs = 3;
  Random random(11);
  const Samples samples{
      Eigen::MatrixXd::NullaryExpr(inputs, pairs, [&] { return random.uniform(-1, 1); }),
      Eigen::MatrixXd::NullaryExpr(outputs, pairs, [&] { return random.uniform(-1, 1); })};
  const std::unique_ptr<fann, void (*)(fann*)> network(
      fann_create_standard(3, inputs, hidden, outputs), fann_destroy);
  const std::unique_ptr<fann_train_data, void (*)(fann_train_data*)> data(
      fann_create_train(static_cast<unsigned>(pairs), inputs, outputs), fann_destroy_train);
  fann_set_activation_function_hidden(network.get(), FANN_SIGMOID_SYMMETRIC);
  fann_set_activation_function_output(network.get(), FANN_SIGMOID_SYMMETRIC);
  fann_set_training_algorithm(network.get(), FANN_TRAIN_RPROP);
  fann_randomize_weights(network.get(), -0.5, 0.5);
  for (int k = 0; k < pairs; ++k) {
    Eigen::VectorXd::Map(data->input[k], inputs) = samples.inputs.col(k);
    Eigen::VectorXd::Map(data->output[k], outputs) = samples.outputs.col(k);
  }
  Rprop ours(layers_of(*network, inputs, hidden, outputs), samples);
  for (int epoch = 0; epoch < 30; ++epoch) {
    fann_train_epoch(network.get(), data.get());
    ours.epoch();
  }
  const auto theirs = layers_of(*network, inputs, hidden, outputs);
  for (std::size_t i = 0; i < theirs.size(); ++i)
    EXPECT_LT((ours.layers()[i] - theirs[i]).cwiseAbs().maxCoeff(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Pairs, RpropTest, testing::Values(2, 100, 300));

}  // namespace
}  // namespace prehend::learning
