#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "services/recorder/core/dataset/recording_log.hpp"

namespace prehend::recorder::dataset {

struct ReadLog {
  RecordingLog log;
  Time start{};               // of the recording's first message
  std::vector<Error> damage;  // what could not be read, or not be used
};

/// What a recording says of a hand; `hand` empty: of the only one. Fails on what is no recording,
/// on one without commands for that hand, and on one whose commands and states do not match.
Expected<ReadLog> read_log(const std::filesystem::path& file, const std::string& hand);

/// The recordings that are meant by files and folders; those of a folder by name. Fails on what is
/// not there, and on a folder without any.
Expected<std::vector<std::filesystem::path>> recordings_of(const std::vector<std::string>& sources);

}  // namespace prehend::recorder::dataset
