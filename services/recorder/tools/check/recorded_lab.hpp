#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/recording/mcap/reader.hpp"
#include "common/recording/types/type.hpp"
#include "services/recorder/service/tape.hpp"

namespace prehend::recorder {

using Settings = std::map<std::string, std::string>;  // of lab.toml: key, value

/// What the head of a recording says of the lab that it was made in.
struct RecordedLab {
  Settings configuration;  // the recorder's; what there is no more is left out
  std::string scene;       // text of the scene file; empty: none
  std::string catalogue;   // of the catalogue; empty: the one that comes with the programs
};
RecordedLab recorded_lab(const recording::mcap::Reader& file);

/// A service that ran while it was recorded.
struct RecordedProcess {
  std::string service;  // mapping, ...
  Settings settings;    // what it was given beside the configuration
};
/// Those that ran side by side: who came after another of that name had ended stands in its place.
/// Empty: nobody told (service/settings).
std::vector<RecordedProcess> recorded_processes(const std::vector<Played>& played,
                                                const recording::types::Library& types);

/// Where a lab was recorded is not where it is checked: is the setting about its network, its
/// devices or its files?
bool is_of_the_machine(const std::string& key);

}  // namespace prehend::recorder
