#pragma once

#include "common/base/error.hpp"
#include "common/learning/training.hpp"
#include "services/mapping/core/mapping_model.hpp"
#include "services/mapping/tools/training/demonstrator.hpp"

namespace prehend::mapping {

struct ClosingLessonOptions {
  int people = 150;
  int things = 12;  // each takes, of drawn shapes and sizes
  int moments = 3;  // of each closing
  /// Share of a person's closing at which a robot hand shall be closed (SetOptions::complete).
  double complete = 0.7;
  std::uint64_t seed = 1;
  DemonstratorOptions demonstrator;
};

/// What synthetic people show who close on cylinders, boxes and spheres of all sizes that a hand
/// can take, from above and from the side: the features and what they see of the object
/// (SizeInput::seen), a column each; and how far they have closed, 0 to 1.
learning::Samples closing_lessons(const ClosingLessonOptions& options);

/// The network of ModelTraits::closing. Other people end the training, and others judge it. The
/// same for the same options.
Expected<MappingNetwork> train_closing(const ClosingLessonOptions& options,
                                       const learning::TrainingOptions& network);

}  // namespace prehend::mapping
