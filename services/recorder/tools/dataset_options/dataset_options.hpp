#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.hpp"

namespace CLI {
class App;
}

namespace prehend::recorder {

/// Of `prehend recording export` where training data are written; prehend-dataset does it.
struct DatasetOptions {
  std::vector<std::string> sources;   // recordings, and folders of them
  std::string format;                 // one of dataset_formats()
  std::string output;                 // file or folder that is made
  double rate = 30;                   // Hz, of the rows
  std::string turns = "quaternion";   // how orientations are written
  std::string size;                   // of pictures, as 84x84; empty: as recorded
  std::vector<std::string> hands;     // side by side, in this order; empty: the only one
  std::string task;                   // its words; empty: as recorded
  std::string columns;                // file that maps topics of others; empty: topics are ours
  std::vector<std::string> episodes;  // FROM..TO, s after the recording's begin; empty: found
  std::string split;                  // as train=0.8,valid=0.2; empty: none
  std::uint64_t split_seed = 1;
};

/// The formats that are training data.
const std::vector<std::string>& dataset_formats();

/// All but sources, format and output.
void add_dataset_options(CLI::App& app, DatasetOptions& options);

/// As they are given to prehend-dataset.
std::vector<std::string> to_arguments(const DatasetOptions& options);

/// Says what cannot be meant.
Expected<void> check(const DatasetOptions& options);
/// Of --episode, s.
Expected<std::vector<std::pair<double, double>>> given_times(const DatasetOptions& options);
/// Width and height, px; nothing where none is asked for.
Expected<std::optional<std::pair<int, int>>> picture_size(const DatasetOptions& options);

}  // namespace prehend::recorder
