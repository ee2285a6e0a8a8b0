#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "services/mapping/tools/judging/benchmark_summary.hpp"
#include "services/mapping/tools/study/study.hpp"

namespace prehend::mapping {

/// Writes a study into a folder, which is made: FIGURE.csv (means and intervals),
/// FIGURE-repetitions.csv (all that was measured), FIGURE.png, benchmark.csv, and report.html, one
/// file that shows everything. Without trials no benchmark was run.
Expected<void> write_report(const std::filesystem::path& folder,
                            const std::vector<Studied>& studied,
                            const std::vector<TrialResult>& trials, const StudyOptions& options);

/// The findings and the benchmark as tables in Markdown, a line each.
std::string to_markdown(const std::vector<Studied>& studied,
                        const std::vector<ModeSummary>& summaries);

}  // namespace prehend::mapping
