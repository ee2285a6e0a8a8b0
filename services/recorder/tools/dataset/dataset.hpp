#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/recorder/core/dataset/features.hpp"
#include "services/recorder/tools/dataset/field_path.hpp"

namespace prehend::recorder::dataset {

/// Of pictures, px.
struct Size {
  int width = 0, height = 0;
};

/// Where the pictures of a camera are: those of camera/image, unless somebody has mapped others.
struct PictureSource {
  std::string topic;
  FieldPath field;
};

struct RecordedEpisode {
  std::filesystem::path file;
  Episode episode;
  Rows rows;
  std::map<std::string, std::vector<Time>> picture_times;  // by camera, of the whole file
  bool simulated = false;                                  // its world
  std::map<std::string, PictureSource> picture_sources;    // by camera
  std::string split;                                       // its part; empty: none
};

/// What the writers of all layouts are given.
struct Dataset {
  double rate = 0;                        // Hz
  std::string hand;                       // kind of hand
  std::vector<RecordedEpisode> episodes;  // at least one; all with the same features
  std::map<std::string, Size> cameras;    // the size of their pictures
  bool sized = false;                     // that size was asked for
  /// Parts of the episodes, which stand in this order, and how many each has; empty: no parts.
  std::vector<std::pair<std::string, std::size_t>> splits;

  bool all_judged() const;
};

}  // namespace prehend::recorder::dataset
