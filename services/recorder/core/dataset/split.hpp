#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.hpp"

namespace prehend::recorder::dataset {

/// Parts of the episodes by name, with their shares; together 1.
using Shares = std::vector<std::pair<std::string, double>>;

/// «train=0.8,valid=0.2».
Expected<Shares> parse_split(const std::string& text);

/// To which part each of so many episodes belongs, drawn by the seed: as many of each as their
/// shares say, rounded, but one at least. Fails where there are more parts than episodes.
Expected<std::vector<std::size_t>> draw_split(const Shares& shares, std::size_t episodes,
                                              std::uint64_t seed);

}  // namespace prehend::recorder::dataset
