#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace prehend::recorder::dataset {

/// A column of a Parquet file. Each row has a value, or an array of the same shape as all others:
/// {7} is a list of 7, {3, 1, 1} a list of three lists of lists of one.
struct Column {
  std::string name;
  std::vector<std::size_t> shape;  // no extent is 0
  /// Row after row, the last index of an array fastest.
  std::variant<std::vector<bool>, std::vector<std::int64_t>, std::vector<float>,
               std::vector<double>, std::vector<std::string>>
      values;

  std::size_t count() const;  // of values
};

/// A Parquet file of these columns, all of so many rows: one row group, a page a column, plain
/// encoding, not compressed. No value is missing, but all may be, as other writers say of theirs.
/// A column has less than 2 GiB.
std::vector<std::uint8_t> parquet(
    const std::vector<Column>& columns, std::size_t rows,
    const std::vector<std::pair<std::string, std::string>>& metadata = {});

}  // namespace prehend::recorder::dataset
