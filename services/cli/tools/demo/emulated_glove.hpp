#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/stage/stage.hpp"
#include "services/cli/tools/demo/rows.hpp"

namespace prehend::cli {

/// A glove that is not there, at the far end of its wire.
struct EmulatedGlove {
  GloveRow row;
  std::filesystem::path scene_file;  // what its wearer reaches for
  std::string port;                  // empty: a free one
  std::string whose;                 // before the names of its processes: "left "; may be empty
  std::vector<std::string> sets;     // of its configuration
};

/// Starts it, with the tracker on its back where it measures only joints (one of rows), and waits
/// until both are plugged in. Returns what its driver must be told, as --set takes it.
Expected<std::vector<std::string>> emulate(const EmulatedGlove& glove,
                                           const std::vector<GloveRow>& rows, stage::Stage& stage);

/// Waits until a serial port is there, which this process opens.
Expected<void> await_port(const std::filesystem::path& port, const std::string& process,
                          stage::Stage& stage);

}  // namespace prehend::cli
