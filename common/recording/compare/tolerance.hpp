#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"

namespace prehend::recording {

/// How far two values of a field may be apart and still count as the same: |a − b| ≤ absolute +
/// relative · max(|a|, |b|).
struct Tolerance {
  double absolute = 0;
  double relative = 0;
  bool ignored = false;  // the field is not compared
};

/// Tolerances by field, as in share/prehend/tolerances.toml: a table a type (its name without
/// scope) with a line a field. A field may be a dotted path, and stands for all below it; the
/// longest one counts. The table «any» is for fields of every type, where the last part of a path
/// is looked for, then «number».
class ToleranceTable {
 public:
  static Expected<ToleranceTable> load(const std::filesystem::path& file);
  static Expected<ToleranceTable> parse(std::string_view toml, const std::string& origin);
  /// The table that came with the programs.
  static Expected<ToleranceTable> load_defaults();

  /// `type` without scope, `path` with dots and without indices, as X_WH.position.x.
  Tolerance of(std::string_view type, std::string_view path) const;
  /// The types that have a table, with «any».
  std::vector<std::string> types() const;
  /// The paths that the table names for a type.
  std::vector<std::string> fields(std::string_view type) const;

 private:
  std::map<std::string, std::map<std::string, Tolerance, std::less<>>, std::less<>> types_;
};

}  // namespace prehend::recording
