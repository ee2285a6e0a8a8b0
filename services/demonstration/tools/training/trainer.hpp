#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/base/error.hpp"
#include "services/demonstration/core/recognition/recogniser.hpp"

namespace prehend::demonstration {

/// How recognisers are trained. What is not here is chosen within the training people.
struct TrainerOptions {
  int folds = 4;          // by person: a network learns from all but one, which says when to stop
  int hidden = 20;        // neurons of a network
  int epochs = 80;        // at most
  int patience = 25;      // epochs without a better answer
  int copies = 1;         // of each grasp, turned about the vertical and stretched a little
  double max_turn = 0.2;  // rad, of a copy about the vertical
  double max_stretch = 0.08;  // share by which a copy is larger or smaller
  std::uint32_t seed = 1;     // of first weights and copies
};

/// Trains recognisers of one task, in the order of `wanted`. Whatever is chosen (when to stop,
/// states and floors of hidden Markov models, weights, temperature) is chosen on people who were
/// left out of a part of the training. Fails on fewer than two people or kinds of grasps.
Expected<std::vector<Recogniser>> train_recognisers(
    const std::vector<const Take*>& takes, const std::vector<Method>& wanted,
    const TrainerOptions& options, const std::function<void(double)>& progress = {});

}  // namespace prehend::demonstration
