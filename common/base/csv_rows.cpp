#include "common/base/csv_rows.hpp"

#include <algorithm>
#include <utility>

#include "common/base/finite_number.hpp"

namespace prehend {

namespace {

/// What comes before the separator; `rest` goes on behind it.
std::string_view cut(std::string_view& rest, char separator) {
  const std::size_t end = rest.find(separator);
  const std::string_view part = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  return part;
}

/// The first cell of a line that is not empty; `rest` goes on behind it.
std::string_view cut_cell(std::string_view& rest, char separator) {
  if (!rest.starts_with('"')) return cut(rest, separator);
  const std::size_t end = rest.find('"', 1);
  // Without its other quote, or with something behind it, it is a cell like any other.
  const bool whole =
      end != std::string_view::npos && (end + 1 == rest.size() || rest[end + 1] == separator);
  if (!whole) return cut(rest, separator);
  const std::string_view cell = rest.substr(1, end - 1);
  rest.remove_prefix(std::min(end + 2, rest.size()));
  return cell;
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  const bool ends_empty = line.ends_with(separator);
  while (!line.empty()) cells.push_back(cut_cell(line, separator));
  if (ends_empty) cells.emplace_back();
  return cells;
}

std::string_view without_blanks(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

char small_letter(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

}  // namespace

bool CsvRow::Less::operator()(std::string_view a, std::string_view b) const {
  return std::ranges::lexicographical_compare(
      a, b, [](char x, char y) { return small_letter(x) < small_letter(y); });
}

std::string_view CsvRow::text(std::string_view column) {
  const auto found = columns_->find(column);
  if (found != columns_->end() && found->second < cells_.size()) return cells_[found->second];
  bad_ = true;
  return {};
}

double CsvRow::number(std::string_view column) {
  std::string cell(text(column));
  if (decimal_comma_) std::ranges::replace(cell, ',', '.');
  if (!cell.starts_with('+'))
    if (const auto value = finite_number(cell)) return *value;
  bad_ = true;
  return 0;
}

Eigen::Vector3d CsvRow::vector(const std::string& name) {
  const double x = number(name + "_x"), y = number(name + "_y"), z = number(name + "_z");
  return {x, y, z};
}

CsvRows::CsvRows(std::string_view text) : rest_(text) {
  if (rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);
  const std::string_view heading = rest_.substr(0, rest_.find('\n'));
  for (const char other : {';', '\t'})
    if (std::ranges::count(heading, other) > std::ranges::count(heading, separator_))
      separator_ = other;
  const auto names = next_cells();
  if (!names) return;
  for (std::size_t i = 0; i < names->size(); ++i) columns_.emplace(without_blanks((*names)[i]), i);
}

std::optional<std::vector<std::string_view>> CsvRows::next_cells() {
  while (!rest_.empty()) {
    std::string_view line = cut(rest_, '\n');
    ++line_;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (!line.empty()) return cells_of(line, separator_);
  }
  return std::nullopt;
}

std::optional<CsvRow> CsvRows::next() {
  auto cells = next_cells();
  if (!cells) return std::nullopt;
  return CsvRow(columns_, std::move(*cells), line_, separator_ != ',');
}

}  // namespace prehend
