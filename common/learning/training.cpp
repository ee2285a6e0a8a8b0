#include "training.hpp"

// The only place that knows FANN; its double variant.
#include <doublefann.h>
#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <limits>
#include <memory>
#include <utility>

namespace prehend::learning {

namespace {

constexpr std::array<std::pair<TrainingMethod, std::string_view>, 5> method_names{{
    {TrainingMethod::incremental, "incremental"},
    {TrainingMethod::batch, "batch"},
    {TrainingMethod::rprop, "rprop"},
    {TrainingMethod::quickprop, "quickprop"},
    {TrainingMethod::sarprop, "sarprop"},
}};

fann_train_enum fann_method(TrainingMethod method) {
  switch (method) {
    case TrainingMethod::incremental:
      return FANN_TRAIN_INCREMENTAL;
    case TrainingMethod::batch:
      return FANN_TRAIN_BATCH;
    case TrainingMethod::quickprop:
      return FANN_TRAIN_QUICKPROP;
    case TrainingMethod::sarprop:
      return FANN_TRAIN_SARPROP;
    case TrainingMethod::rprop:
      break;
  }
  return FANN_TRAIN_RPROP;
}

struct Destroy {
  void operator()(fann* network) const { fann_destroy(network); }
  void operator()(fann_train_data* data) const { fann_destroy_train(data); }
};
using FannNetwork = std::unique_ptr<fann, Destroy>;
using FannData = std::unique_ptr<fann_train_data, Destroy>;

FannData to_fann(const Samples& samples) {
  FannData data(fann_create_train(static_cast<unsigned>(samples.inputs.cols()),
                                  static_cast<unsigned>(samples.inputs.rows()),
                                  static_cast<unsigned>(samples.outputs.rows())));
  if (!data) return data;
  for (Eigen::Index k = 0; k < samples.inputs.cols(); ++k) {
    Eigen::VectorXd::Map(data->input[k], samples.inputs.rows()) = samples.inputs.col(k);
    Eigen::VectorXd::Map(data->output[k], samples.outputs.rows()) = samples.outputs.col(k);
  }
  return data;
}

/// FANN keeps the weights of a fully connected network layer by layer, neuron by neuron, the bias
/// last.
std::vector<Layer> weights_of(const fann& network, const std::array<int, 3>& sizes) {
  std::vector<Layer> layers;
  const fann_type* weight = network.weights;
  for (std::size_t i = 0; i + 1 < sizes.size(); ++i) {
    Layer layer(sizes[i + 1], sizes[i] + 1);
    for (Eigen::Index row = 0; row < layer.rows(); ++row)
      for (Eigen::Index col = 0; col < layer.cols(); ++col) layer(row, col) = *weight++;
    layers.push_back(std::move(layer));
  }
  return layers;
}

Expected<void> check(const Samples& samples, std::string_view which) {
  if (samples.inputs.cols() != samples.outputs.cols())
    return fail(
        fmt::format("{} inputs and {} outputs", samples.inputs.cols(), samples.outputs.cols()),
        std::string(which));
  if (!samples.inputs.allFinite() || !samples.outputs.allFinite())
    return fail("samples are not finite", std::string(which));
  return {};
}

}  // namespace

std::string_view to_string(TrainingMethod method) {
  for (const auto& [value, name] : method_names)
    if (value == method) return name;
  return "unknown";
}

std::optional<TrainingMethod> method_from_string(std::string_view name) {
  for (const auto& [value, text] : method_names)
    if (text == name) return value;
  return std::nullopt;
}

double squared_error(const Network& network, const Samples& samples) {
  double sum = 0;
  for (Eigen::Index k = 0; k < samples.inputs.cols(); ++k)
    sum += (network.evaluate(samples.inputs.col(k)) - samples.outputs.col(k)).squaredNorm();
  return samples.inputs.cols() == 0 ? 0.0 : sum / static_cast<double>(samples.inputs.cols());
}

Expected<TrainingResult> train(const Samples& training, const Samples& validation,
                               const TrainingOptions& options,
                               const std::function<void(double)>& progress) {
  if (auto ok = check(training, "training samples"); !ok) return tl::unexpected(ok.error());
  if (auto ok = check(validation, "validation samples"); !ok) return tl::unexpected(ok.error());
  if (training.inputs.cols() < 2 || training.inputs.rows() < 1 || training.outputs.rows() < 1)
    return fail("fewer than two pairs to learn from", "training samples");
  const bool validated = validation.inputs.cols() > 0;
  if (validated && (validation.inputs.rows() != training.inputs.rows() ||
                    validation.outputs.rows() != training.outputs.rows()))
    return fail("sizes differ from those of the training samples", "validation samples");
  if (options.hidden < 1 || options.epochs < 1 || options.check_every < 1)
    return fail("hidden neurons, epochs and check_every must be at least 1", "training options");

  const std::array<int, 3> sizes{static_cast<int>(training.inputs.rows()), options.hidden,
                                 static_cast<int>(training.outputs.rows())};
  fann_set_error_log(nullptr, nullptr);  // it would write to standard error
  const FannNetwork network(fann_create_standard(3, sizes[0], sizes[1], sizes[2]));
  const FannData data = to_fann(training);
  if (!network || !data) return fail("no memory for a network", "training");
  fann_set_activation_function_hidden(network.get(), FANN_SIGMOID_SYMMETRIC);
  fann_set_activation_function_output(network.get(), FANN_SIGMOID_SYMMETRIC);
  fann_set_training_algorithm(network.get(), fann_method(options.method));
  fann_set_learning_rate(network.get(), static_cast<float>(options.learning_rate));
  // fann_create_standard has just seeded rand() from the system; only this makes it repeatable.
  std::srand(options.seed);
  fann_randomize_weights(network.get(), -0.5, 0.5);

  const Samples& judged = validated ? validation : training;
  std::optional<Network> best;
  double best_error = std::numeric_limits<double>::infinity();
  int best_epoch = 0, epoch = 0;
  while (epoch < options.epochs) {
    fann_train_epoch(network.get(), data.get());
    ++epoch;
    if (epoch % options.check_every != 0 && epoch != options.epochs) continue;
    auto now = Network::create(weights_of(*network, sizes));
    if (!now) break;  // diverged; the best so far stands
    const double error = squared_error(*now, judged);
    if (error < best_error) {
      best_error = error;
      best_epoch = epoch;
      best = std::move(*now);
    }
    if (progress) progress(static_cast<double>(epoch) / options.epochs);
    if (epoch - best_epoch >= options.patience) break;
  }
  if (!best)
    return fail("training diverged", std::string(to_string(options.method)),
                "choose rprop or a smaller learning rate");
  const double training_error = squared_error(*best, training);
  if (progress) progress(1.0);
  return TrainingResult{std::move(*best), training_error, best_error, epoch};
}

}  // namespace prehend::learning
