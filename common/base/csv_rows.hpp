#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace prehend {

/// One row of a table, read by the names of its columns. Anything that is missing or unreadable
/// makes it bad, so that a reader asks for all that it needs and then once whether it was there.
class CsvRow {
 public:
  /// Capitals count as small letters.
  struct Less {
    bool operator()(std::string_view a, std::string_view b) const;
  };
  using Columns = std::map<std::string_view, std::size_t, Less>;
  CsvRow(const Columns& columns, std::vector<std::string_view> cells, std::size_t line,
         bool decimal_comma)
      : columns_(&columns), cells_(std::move(cells)), line_(line), decimal_comma_(decimal_comma) {}

  std::string_view text(std::string_view column);
  /// A finite decimal number; 0 where there is none.
  double number(std::string_view column);
  /// From the three columns NAME_x, NAME_y, NAME_z.
  Eigen::Vector3d vector(const std::string& name);
  bool bad() const { return bad_; }
  /// Of the text, from 1.
  std::size_t line() const { return line_; }

 private:
  const Columns* columns_;
  std::vector<std::string_view> cells_;
  std::size_t line_;
  bool decimal_comma_;
  bool bad_ = false;
};

/// A table as text: a row a line, the first one names the columns. Between cells stand commas or,
/// if that is what stands between the names, semicolons or tabs; then numbers may have decimal
/// commas, as spreadsheets write them where people do. A cell may stand in quotes, without any
/// inside; blanks around names do not count. A byte order mark is passed by; lines may end in CR
/// LF; empty ones are no rows. Keeps the text by reference, and rows keep the table.
class CsvRows {
 public:
  explicit CsvRows(std::string_view text);
  CsvRows(const CsvRows&) = delete;
  CsvRows& operator=(const CsvRows&) = delete;

  /// There is no line at all.
  bool empty() const { return columns_.empty(); }
  bool has(std::string_view column) const { return columns_.contains(column); }
  /// The next row, from the first on; nullopt at the end.
  std::optional<CsvRow> next();

 private:
  std::optional<std::vector<std::string_view>> next_cells();

  std::string_view rest_;
  std::size_t line_ = 0;  // that was read last
  char separator_ = ',';
  CsvRow::Columns columns_;
};

}  // namespace prehend
