#pragma once

#include <vector>

#include "common/base/error.hpp"
#include "services/recorder/tools/dataset/dataset.hpp"
#include "services/recorder/tools/dataset_options/dataset_options.hpp"

namespace prehend::recorder::dataset {

struct Gathered {
  Dataset dataset;
  std::vector<Error> passed_by;       // recordings, parts of them, episodes
  std::vector<std::string> left_out;  // features that not every episode has
};

/// Reads all recordings and makes rows of their episodes. Of several recordings one that cannot be
/// used is passed by; fails where nothing is left, and on hands of different kinds.
Expected<Gathered> gather(const DatasetOptions& options);

}  // namespace prehend::recorder::dataset
