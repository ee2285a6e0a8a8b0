#pragma once

#include <filesystem>
#include <functional>

#include "common/base/error.hpp"
#include "services/recorder/tools/dataset/dataset.hpp"

/// Each layout's writer. What is written is not there yet; after a failure, a part of it may be.
/// `written` is called after each episode.
namespace prehend::recorder::dataset {

using Written = std::function<void()>;

/// One HDF5 file of all episodes.
Expected<void> write_robomimic(const Dataset& dataset, const std::filesystem::path& file,
                               const Written& written);

/// A folder of HDF5 files, one an episode.
Expected<void> write_aloha(const Dataset& dataset, const std::filesystem::path& folder,
                           const Written& written);

/// A folder of Parquet, mp4 and JSON: many episodes a file, or as version 2.1 wants it, one.
Expected<void> write_lerobot(const Dataset& dataset, const std::filesystem::path& folder,
                             const Written& written);
Expected<void> write_lerobot_v21(const Dataset& dataset, const std::filesystem::path& folder,
                                 const Written& written);

}  // namespace prehend::recorder::dataset
