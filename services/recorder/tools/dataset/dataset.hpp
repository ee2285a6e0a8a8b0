#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/recorder/core/dataset/features.hpp"

namespace prehend::recorder::dataset {

/// Of pictures, px.
struct Size {
  int width = 0, height = 0;
};

struct RecordedEpisode {
  std::filesystem::path file;
  Episode episode;
  Rows rows;
  std::map<std::string, std::vector<Time>> picture_times;  // by camera, of the whole file
  bool simulated = false;                                  // its world
};

/// What the writers of all layouts are given.
struct Dataset {
  double rate = 0;                        // Hz
  std::string hand;                       // kind of hand
  std::vector<RecordedEpisode> episodes;  // at least one; all with the same features
  std::map<std::string, Size> cameras;    // the size of their pictures
  bool sized = false;                     // that size was asked for

  bool all_judged() const;
};

}  // namespace prehend::recorder::dataset
