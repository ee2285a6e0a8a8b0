#pragma once

#include <string>
#include <vector>

#include "common/recording/types/value.hpp"

namespace prehend::recorder {

/// Names of the columns that a type has as a table: a column a value, structures and arrays taken
/// apart (X_WH.position.x, covariance[3]), sequences in one.
std::vector<std::string> columns(const recording::types::Structure& type);

/// A message as a row of such a table: cells as CSV wants them (RFC 4180), sequences as JSON.
std::vector<std::string> cells(const recording::types::Structure& type,
                               const recording::types::Value& message);

}  // namespace prehend::recorder
