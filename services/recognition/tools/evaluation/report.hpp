#pragma once

#include "common/base/error.hpp"
#include "services/recognition/tools/evaluation/judged.hpp"

namespace prehend::recognition {

/// Writes `index.html` into a folder, which is made: the confusion matrix, the reliability diagram
/// (as a picture beside it, where gnuplot is there) and the pictures that were taken for the wrong
/// class or, strangers, accepted at the threshold, each small, with its name and what it was taken
/// for. One file by itself: the small pictures lie in it.
Expected<void> write_report(const std::filesystem::path& folder, const std::string& title,
                            const std::vector<std::string>& classes,
                            std::span<const Judged> pictures, double threshold);

/// What was said against what held, with 95 % intervals, as a PNG.
Expected<void> draw_reliability(const std::filesystem::path& png, const std::string& title,
                                std::span<const Judged> pictures);

}  // namespace prehend::recognition
