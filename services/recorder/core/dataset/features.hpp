#pragma once

#include <string>
#include <vector>

#include "services/recorder/core/dataset/rows.hpp"

namespace prehend::recorder::dataset {

/// Leaves in every episode the features and cameras that all of them have, with the same columns:
/// who trains needs the same in each. Returns the names of what was left out, sorted.
std::vector<std::string> keep_common(const std::vector<Rows*>& episodes);

/// Of each column.
struct Statistics {
  Eigen::VectorXd min, max, mean, deviation;  // the last with the count as its divisor
  std::size_t count = 0;
};
/// Of at least one row.
Statistics statistics(const Table& values);
/// Of all rows of several tables, from those of each.
Statistics together(const std::vector<Statistics>& parts);

/// Values from -1 (min) to 1 (max), column by column; 0 where a column does not change.
Table scaled(const Table& values, const Statistics& range);

}  // namespace prehend::recorder::dataset
