#include "common/learning/training.hpp"

// The only place that knows FANN; its double variant.
#include <doublefann.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>

#include "common/base/named_values.hpp"
#include "common/learning/rprop.hpp"

namespace prehend::learning {

namespace {

constexpr auto method_names =
    named_values<TrainingMethod>({{TrainingMethod::incremental, "incremental"},
                                  {TrainingMethod::batch, "batch"},
                                  {TrainingMethod::rprop, "rprop"},
                                  {TrainingMethod::quickprop, "quickprop"},
                                  {TrainingMethod::sarprop, "sarprop"},
                                  {TrainingMethod::cascade, "cascade"}});
static_assert(method_names.size() == training_methods.size());

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
    case TrainingMethod::cascade:  // how it trains candidates and outputs
      break;
  }
  return FANN_TRAIN_RPROP;
}

bool draws_while_training(TrainingMethod method) {
  return method == TrainingMethod::sarprop || method == TrainingMethod::cascade;
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

/// FANN keeps the weights neuron by neuron, in the order of the neurons that they come from. Each
/// layer ends with a bias neuron; with shortcuts only the inputs do.
Expected<Network> to_network(const fann& from) {
  const bool shortcut = from.network_type == FANN_NETTYPE_SHORTCUT;
  std::vector<Layer> layers;
  for (const fann_layer* l = from.first_layer + 1; l != from.last_layer; ++l) {
    const auto rows = l->last_neuron - l->first_neuron - (shortcut ? 0 : 1);
    const auto cols = static_cast<Eigen::Index>(l->first_neuron->last_con) -
                      static_cast<Eigen::Index>(l->first_neuron->first_con);
    const auto bias = shortcut ? static_cast<Eigen::Index>(from.num_input) : cols - 1;
    Layer layer(rows, cols);
    for (Eigen::Index row = 0; row < rows; ++row) {
      const auto weights =
          Eigen::RowVectorXd::Map(from.weights + l->first_neuron[row].first_con, cols);
      layer.row(row) << weights.head(bias), weights.tail(cols - 1 - bias), weights[bias];
    }
    layers.push_back(std::move(layer));
  }
  return Network::create(std::move(layers), shortcut ? Wiring::shortcut : Wiring::layered);
}

/// FANN seeds rand() whenever it makes a network, and some methods draw from it.
std::mutex& rand_mutex() {
  static std::mutex mutex;
  return mutex;
}

/// A network with random first weights. Call with the mutex locked.
FannNetwork make_fann(int inputs, int outputs, const TrainingOptions& options) {
  fann_set_error_log(nullptr, nullptr);  // it would write to standard error
  const bool cascade = options.method == TrainingMethod::cascade;
  FannNetwork network(cascade ? fann_create_shortcut(2, inputs, outputs)
                              : fann_create_standard(3, inputs, options.hidden, outputs));
  if (!network) return network;
  fann_set_activation_function_hidden(network.get(), FANN_SIGMOID_SYMMETRIC);
  fann_set_activation_function_output(network.get(), FANN_SIGMOID_SYMMETRIC);
  fann_set_training_algorithm(network.get(), fann_method(options.method));
  fann_set_learning_rate(network.get(), static_cast<float>(options.learning_rate));
  if (cascade) {
    // Every neuron has the one activation that Network knows; candidates differ by their weights.
    constexpr unsigned candidates = 8;
    fann_activationfunc_enum activation = FANN_SIGMOID_SYMMETRIC;
    fann_type steepness = 0.5;
    fann_set_cascade_activation_functions(network.get(), &activation, 1);
    fann_set_cascade_activation_steepnesses(network.get(), &steepness, 1);
    fann_set_cascade_num_candidate_groups(network.get(), candidates);
  }
  std::srand(options.seed);
  fann_randomize_weights(network.get(), -0.5, 0.5);
  return network;
}

/// Looks at a network now and then while it is trained, and keeps the best.
class Judge {
 public:
  Judge(const Samples& training, const Samples& validation, const TrainingOptions& options,
        const std::function<void(double)>& progress)
      : training_(training),
        validation_(validation),
        validated_(validation.inputs.cols() > 0),
        options_(options),
        progress_(progress) {}

  double best_error() const { return best_error_; }

  /// False when there is no point in training on.
  bool look(Expected<Network> now, int epoch) {
    epochs_ = epoch;
    if (!now) return false;  // diverged; the best so far stands
    const double error = squared_error(*now, validated_ ? validation_ : training_);
    if (options_.curve)
      curve_.push_back({epoch, validated_ ? squared_error(*now, training_) : error, error});
    if (error < best_error_) {
      best_error_ = error;
      best_epoch_ = epoch;
      best_ = std::move(*now);
    }
    if (progress_) progress_(std::min(1.0, static_cast<double>(epoch) / options_.epochs));
    return epoch < options_.epochs && epoch - best_epoch_ < options_.patience;
  }

  Expected<TrainingResult> result() {
    if (!best_)
      return fail("training diverged", std::string(to_string(options_.method)),
                  "choose rprop or a smaller learning rate");
    const double training_error = squared_error(*best_, training_);
    if (progress_) progress_(1.0);
    return TrainingResult{std::move(*best_), training_error, best_error_, epochs_,
                          std::move(curve_)};
  }

 private:
  const Samples &training_, &validation_;
  bool validated_;
  const TrainingOptions& options_;
  const std::function<void(double)>& progress_;
  std::optional<Network> best_;
  double best_error_ = std::numeric_limits<double>::infinity();
  int best_epoch_ = 0, epochs_ = 0;
  std::vector<Look> curve_;
};

void train_cascade(fann& network, fann_train_data& data, const TrainingOptions& options,
                   Judge& judge) {
  struct Growing {
    Judge& judge;
    unsigned epochs = 0;
    bool ended = false;
  } growing{judge};
  fann_set_user_data(&network, &growing);
  // Called when the outputs have been trained, before another neuron is grown.
  fann_set_callback(&network,
                    [](fann* now, fann_train_data*, unsigned, unsigned, float, unsigned epochs) {
                      auto& seen = *static_cast<Growing*>(fann_get_user_data(now));
                      seen.epochs = epochs;
                      seen.ended = !seen.judge.look(to_network(*now), static_cast<int>(epochs));
                      return seen.ended ? -1 : 0;
                    });
  fann_cascadetrain_on_data(&network, &data, static_cast<unsigned>(options.hidden), 1, 0);
  // Outputs have been trained once more after the last neuron, in epochs that FANN does not tell.
  if (!growing.ended) judge.look(to_network(network), static_cast<int>(growing.epochs));
}

/// A network while it is trained. FANN makes its first weights and trains it, but for RPROP, which
/// our own does faster.
class Run {
 public:
  Run(FannNetwork network, fann_train_data& data, const Samples& training,
      const TrainingOptions& options, Judge judge)
      : network_(std::move(network)), data_(data), options_(options), judge_(std::move(judge)) {
    if (options.method == TrainingMethod::rprop)
      rprop_.emplace(to_network(*network_)->layers(), training);
  }

  /// Until so many epochs are done, or there is no point in training on. Cascade trains to its end.
  void train_until(int epochs) {
    if (options_.method == TrainingMethod::cascade) {
      if (!ended_) train_cascade(*network_, data_, options_, judge_);
      ended_ = true;
    }
    while (!ended_ && epoch_ < epochs) {
      if (rprop_)
        rprop_->epoch();
      else
        fann_train_epoch(network_.get(), &data_);
      ++epoch_;
      if (epoch_ % options_.check_every == 0 || epoch_ == options_.epochs)
        ended_ = !judge_.look(rprop_ ? Network::create(rprop_->layers()) : to_network(*network_),
                              epoch_);
    }
  }
  double best_error() const { return judge_.best_error(); }
  Expected<TrainingResult> result() { return judge_.result(); }

 private:
  FannNetwork network_;
  fann_train_data& data_;
  const TrainingOptions& options_;
  Judge judge_;
  std::optional<Rprop> rprop_;
  int epoch_ = 0;
  bool ended_ = false;
};

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
  return method_names.name(method);
}

std::optional<TrainingMethod> method_from_string(std::string_view name) {
  return method_names.value(name);
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
  if (options.hidden < 1 || options.epochs < 1 || options.check_every < 1 || options.restarts < 1)
    return fail("hidden neurons, epochs, check_every and restarts must be at least 1",
                "training options");
  const FannData data = to_fann(training);
  if (!data) return fail("no memory for the samples", "training");

  const bool draws = draws_while_training(options.method);
  const int heat = draws || options.restarts == 1 ? options.epochs : options.heat;
  const double all = heat * (options.restarts - 1.0) + options.epochs;
  double done = 0;  // epochs of the runs before
  const std::function<void(double)> tell = [&](double share) {
    if (progress) progress(std::min(1.0, (done + share * options.epochs) / all));
  };
  std::vector<Run> runs;
  for (int restart = 0; restart < options.restarts; ++restart) {
    TrainingOptions own = options;
    own.seed += static_cast<std::uint32_t>(restart);
    std::unique_lock lock(rand_mutex());
    FannNetwork network = make_fann(static_cast<int>(training.inputs.rows()),
                                    static_cast<int>(training.outputs.rows()), own);
    if (!network) return fail("no memory for a network", "training");
    if (!draws) lock.unlock();
    runs.emplace_back(std::move(network), *data, training, options,
                      Judge(training, validation, options, tell));
    runs.back().train_until(heat);
    done = heat * std::min(restart + 1.0, options.restarts - 1.0);
  }
  Run& best = *std::min_element(runs.begin(), runs.end(), [](const Run& one, const Run& other) {
    return one.best_error() < other.best_error();
  });
  best.train_until(options.epochs);
  return best.result();
}

}  // namespace prehend::learning
