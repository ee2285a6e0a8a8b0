#include "common/base/csv_rows.hpp"

#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

namespace prehend {

namespace {

/// What comes before the separator; `rest` goes on behind it.
std::string_view cut(std::string_view& rest, char separator) {
  const std::size_t end = rest.find(separator);
  const std::string_view part = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  return part;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  const bool ends_empty = line.ends_with(',');
  while (!line.empty()) cells.push_back(cut(line, ','));
  if (ends_empty) cells.emplace_back();
  return cells;
}

}  // namespace

std::string_view CsvRow::text(std::string_view column) {
  const auto found = columns_->find(column);
  if (found != columns_->end() && found->second < cells_.size()) return cells_[found->second];
  bad_ = true;
  return {};
}

double CsvRow::number(std::string_view column) {
  const std::string_view cell = text(column);
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error == std::errc() && end == cell.data() + cell.size() && std::isfinite(value))
    return value;
  bad_ = true;
  return 0;
}

Eigen::Vector3d CsvRow::vector(const std::string& name) {
  const double x = number(name + "_x"), y = number(name + "_y"), z = number(name + "_z");
  return {x, y, z};
}

CsvRows::CsvRows(std::string_view text) : rest_(text) {
  const auto names = next_cells();
  if (!names) return;
  for (std::size_t i = 0; i < names->size(); ++i) columns_.emplace((*names)[i], i);
}

std::optional<std::vector<std::string_view>> CsvRows::next_cells() {
  while (!rest_.empty()) {
    std::string_view line = cut(rest_, '\n');
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (!line.empty()) return cells_of(line);
  }
  return std::nullopt;
}

std::optional<CsvRow> CsvRows::next() {
  auto cells = next_cells();
  if (!cells) return std::nullopt;
  return CsvRow(columns_, std::move(*cells));
}

}  // namespace prehend
