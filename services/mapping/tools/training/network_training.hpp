#pragma once

#include <functional>

#include "common/learning/scaling.hpp"
#include "common/learning/training.hpp"
#include "services/mapping/core/mapping_model.hpp"

namespace prehend::mapping {

/// Columns of inputs and outputs, unscaled: to learn from, to end by, to judge by.
struct NetworkSamples {
  learning::Samples training, validation, test;
};

/// Fits the scalings to what is learnt from, the outputs with some room beside their range, and
/// trains. Fails as these do. The same for the same samples and options.
Expected<MappingNetwork> train_network(const NetworkSamples& samples, model::ShapeKind shape,
                                       learning::ScalingKind scaling,
                                       const learning::TrainingOptions& options,
                                       const std::function<void(double)>& progress = {});

}  // namespace prehend::mapping
