#pragma once

#include <filesystem>
#include <vector>

#include "common/base/error.hpp"
#include "services/recorder/core/dataset/mapped_log.hpp"
#include "services/recorder/tools/dataset/columns_file.hpp"

namespace prehend::recorder::dataset {

struct ReadMapped {
  MappedLog log;
  Time start{};               // of the recording's first message
  std::vector<Error> damage;  // what could not be read, or not be used
};

/// What a recording says of what the columns name. Fails on what is no recording, and where one of
/// them has no message that can be used.
Expected<ReadMapped> read_mapped(const std::filesystem::path& file, const ColumnsFile& columns);

}  // namespace prehend::recorder::dataset
