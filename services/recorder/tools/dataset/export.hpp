#pragma once

#include "services/recorder/tools/dataset_options/dataset_options.hpp"

namespace prehend::recorder::dataset {

/// Writes recordings as training data. What was made appears under its name when it is whole.
/// Says what it did on standard output, what was passed by on standard error, and returns the
/// exit code: 1 where something was passed by.
int write_dataset(const DatasetOptions& options);

}  // namespace prehend::recorder::dataset
