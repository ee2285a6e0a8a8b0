#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/statistics/intervals.hpp"

namespace prehend::mapping {

enum class Reproduction { reproduced, not_reproduced, undecided };
std::string_view to_string(Reproduction verdict);

/// What [Thesis] claims, what was measured, and what follows.
struct Finding {
  std::string figure;    // «5.14»
  std::string claim;     // of [Thesis], as a statement that can be checked
  std::string measured;  // means with their 95 % intervals
  Reproduction verdict = Reproduction::undecided;
  std::string reason;  // why this verdict, and where the claim fails what limits it
};

/// Judges «this number is above zero» by its interval: reproduced when it lies above, not
/// reproduced when it lies below `least`, which is the smallest number worth the name, and
/// undecided otherwise.
Reproduction above_zero(const statistics::Interval& interval, double least = 0);

/// The same for «this ratio is above one»; `least` is the smallest worth the name.
Reproduction above_one(const statistics::Interval& ratio, double least = 1.05);

/// Of a claim in parts: reproduced when all are, not reproduced when any is not.
Reproduction all_of(std::span<const Reproduction> parts);

/// «0.123 [0.101, 0.145]», with three digits that count.
std::string to_text(const statistics::Interval& interval);

}  // namespace prehend::mapping
