#include "common/learning/rprop.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::learning {

namespace {

using Eigen::ArrayXXd;
using Eigen::Index;
using Eigen::MatrixXd;

// As in FANN, whose results these must be; some of its numbers are floats.
constexpr double rprop_steepness = 0.5;
constexpr double first_step = 0.1f, min_step = 0.0001, max_step = 50;
constexpr double faster = 1.2f, slower = 0.5;
constexpr double max_weight = 1500;
constexpr double flattest = 0.98f;  // of an answer: beyond, the sigmoid's slope counts as there
constexpr double wrong = 0.9999999, max_wrong = 17;  // of a difference, and what it then counts

ArrayXXd slope_of(const auto& answers) {
  const ArrayXXd y = answers.max(-flattest).min(flattest);
  return rprop_steepness * (1 - y * y);
}

void step(Layer& weights, Layer& steps, Layer& before, const MatrixXd& slopes) {
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    double& size = steps.data()[i];
    double slope = slopes.data()[i];
    size = std::max(size, min_step);
    if (before.data()[i] * slope >= 0) {
      size = std::min(size * faster, max_step);
    } else {
      size *= slower;
      slope = 0;
    }
    double& weight = weights.data()[i];
    weight = slope < 0 ? std::max(weight - size, -max_weight) : std::min(weight + size, max_weight);
    before.data()[i] = slope;
  }
}

}  // namespace

Rprop::Rprop(std::vector<Layer> layers, const Samples& samples)
    : layers_(std::move(layers)),
      inputs_(MatrixXd::Ones(samples.inputs.rows() + 1, samples.inputs.cols())),
      wanted_(samples.outputs) {
  inputs_.topRows(samples.inputs.rows()) = samples.inputs;
  for (const Layer& layer : layers_) {
    slopes_.push_back(Layer::Zero(layer.rows(), layer.cols()));
    steps_.push_back(Layer::Constant(layer.rows(), layer.cols(), first_step));
  }
  before_ = slopes_;
}

void Rprop::learn(Index begin, Index count) {
  std::vector<MatrixXd> seen{inputs_.middleCols(begin, count)};
  ArrayXXd answers;
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const MatrixXd sums = layers_[i] * seen[i];
    answers = 2.0 / (1.0 + (-2.0 * rprop_steepness * sums.array()).exp()) - 1.0;
    if (i + 1 == layers_.size()) break;
    seen.push_back(MatrixXd::Ones(answers.rows() + 1, count));
    seen.back().topRows(answers.rows()) = answers.matrix();
  }
  // Half the difference, since answers span 2; its inverse hyperbolic tangent, twice.
  ArrayXXd error = (wanted_.middleCols(begin, count).array() - answers) / 2;
  error = (error.abs() < wrong).select(((1 + error) / (1 - error)).log(), error.sign() * max_wrong);
  error *= slope_of(answers);
  for (std::size_t i = layers_.size(); i-- > 0;) {
    slopes_[i] += error.matrix() * seen[i].transpose();
    if (i == 0) break;
    const auto below = layers_[i].cols() - 1;
    const MatrixXd back = layers_[i].leftCols(below).transpose() * error.matrix();
    error = back.array() * slope_of(seen[i].topRows(below).array());
  }
}

void Rprop::epoch() {
  for (Layer& slopes : slopes_) slopes.setZero();
  constexpr Index at_once = 128;  // all that is needed for so many stays in the nearest cache
  for (Index begin = 0; begin < inputs_.cols(); begin += at_once)
    learn(begin, std::min(at_once, inputs_.cols() - begin));
  for (std::size_t i = 0; i < layers_.size(); ++i)
    step(layers_[i], steps_[i], before_[i], slopes_[i]);
}

}  // namespace prehend::learning
