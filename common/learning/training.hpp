#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/learning/network.hpp"

namespace prehend::learning {

enum class TrainingMethod { incremental, batch, rprop, quickprop, sarprop, cascade };

inline constexpr std::array training_methods{TrainingMethod::incremental, TrainingMethod::batch,
                                             TrainingMethod::rprop,       TrainingMethod::quickprop,
                                             TrainingMethod::sarprop,     TrainingMethod::cascade};

std::string_view to_string(TrainingMethod method);
std::optional<TrainingMethod> method_from_string(std::string_view name);

/// Pairs of network input and output, both scaled, a column a pair.
struct Samples {
  Eigen::MatrixXd inputs, outputs;
};

struct TrainingOptions {
  TrainingMethod method = TrainingMethod::rprop;  // rprop is ours, the others are FANN's
  int hidden = 8;              // neurons of the one hidden layer; cascade grows so many at most
  int epochs = 2000;           // at most
  double learning_rate = 0.7;  // of the methods that have one
  int check_every = 10;        // epochs between looks at the errors; cascade looks at each neuron
  int patience = 200;          // epochs without a better validation error before it stops
  std::uint32_t seed = 1;      // of the first weights
  int restarts = 1;            // first weights that are tried, with the seeds seed, seed + 1, …
  int heat = 200;              // epochs after which only the best of them goes on
  bool curve = false;          // keep the errors of every look
};

/// Mean over samples of the sum over outputs of squared differences [Thesis, eq. 5.1], in scaled
/// units.
double squared_error(const Network& network, const Samples& samples);

/// Errors after so many epochs.
struct Look {
  int epoch = 0;
  double training = 0, validation = 0;  // squared_error
};

struct TrainingResult {
  Network network;              // the best one seen, by validation error
  double training_error = 0;    // squared_error of it
  double validation_error = 0;  // the same on the validation samples; on the training ones without
  int epochs = 0;               // that it was trained
  std::vector<Look> curve;      // if it was asked for
};

/// Trains a network with one hidden layer, or by cascade one that grows neuron by neuron, each
/// seeing all before it. Stops early when the error on `validation` (may be empty: then the
/// training error) no longer improves, and returns the best network seen. Of several first weights
/// the one with the least such error after `heat` epochs is trained to the end; SARPROP and
/// cascade, which draw from the C library's rand() on their way, train each to the end. The same
/// samples, options and seed give the same network bit for bit. Several threads may train at once;
/// those two methods then take turns. `progress` is told the share of epochs done, 0 to 1.
Expected<TrainingResult> train(const Samples& training, const Samples& validation,
                               const TrainingOptions& options,
                               const std::function<void(double)>& progress = {});

}  // namespace prehend::learning
