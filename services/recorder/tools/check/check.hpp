#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/dds/topic.hpp"
#include "common/recording/compare/comparison.hpp"
#include "common/recording/types/type.hpp"
#include "common/service/arguments.hpp"
#include "services/recorder/service/tape.hpp"

namespace prehend::recorder {

/// Roles that `check` runs and compares: services of ours whose answers follow from their inputs.
inline constexpr std::array checkable{dds::Role::glove,      dds::Role::recognition,
                                      dds::Role::mapping,    dds::Role::planner,
                                      dds::Role::simulation, dds::Role::demonstration};

struct CheckOptions {
  std::filesystem::path file;         // the recording
  std::vector<std::string> services;  // those to run; empty: all whose answers were recorded
  service::LabArguments lab;          // overrides of the recorded configuration
  std::filesystem::path log_folder;   // what the services say
};

/// What came of it: the comparison, and the answers themselves by topic in the order given.
struct Checked {
  recording::Report report;
  std::vector<std::string> services;                           // those that ran, each process
  std::map<std::string, std::vector<dds::RawSample>> answers;  // `received` is the log time
  double recorded_s = 0, elapsed_s = 0;
};

/// Runs services as real processes on a recording's inputs, in lockstep and as fast as they can,
/// as many of each as there were, with the settings that each had, and compares what they publish
/// with what was recorded. Every cycle has the log time of what is fed in it; an answer's log time
/// is the cycle in which others read it, so that one service alone finds its inputs in the same
/// cycles as all together.
Expected<Checked> check(const CheckOptions& options, const recording::types::Library& types,
                        const recording::ToleranceTable& tolerances,
                        const std::function<void(double share)>& progress);

/// Writes the recording again with these answers instead of the recorded ones.
Expected<void> update(const std::filesystem::path& file, const Checked& checked);

}  // namespace prehend::recorder
