#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/architecture/agreed.hpp"
#include "tests/architecture/house.hpp"

namespace prehend::architecture {

struct Violation {
  std::string file;
  int line = 0;
  std::string what;
};

using Violations = std::vector<Violation>;

/// A rule of the house: who breaks it, by what is in the house and nothing else.
struct Rule {
  std::string_view name;
  std::string_view to_do;  // for whom it stops
  Violations (*broken)(const House&, const Agreed&);
};

/// All rules.
std::span<const Rule> rules();

/// file:line: what (rule NAME: what to do)
std::vector<std::string> violations(const Rule& rule, const House& house, const Agreed& agreed);

Violations broken_includes(const House& house, const Agreed& agreed);
Violations broken_edges(const House& house, const Agreed& agreed);
Violations broken_layers(const House& house, const Agreed& agreed);
Violations impure_cores(const House& house, const Agreed& agreed);
Violations broken_targets(const House& house, const Agreed& agreed);
Violations broken_namespaces(const House& house, const Agreed& agreed);
Violations broken_functions(const House& house, const Agreed& agreed);
Violations unlike_services(const House& house, const Agreed& agreed);
Violations strays_at_the_root(const House& house, const Agreed& agreed);
Violations broken_pages(const House& house, const Agreed& agreed);
Violations retired_words(const House& house, const Agreed& agreed);
Violations process_ends_in_libraries(const House& house, const Agreed& agreed);
Violations misnamed_commands(const House& house, const Agreed& agreed);
Violations overgrown_mains(const House& house, const Agreed& agreed);

/// Edges from folder to folder that sources make by what they include, and one place for each.
std::map<std::pair<std::string, std::string>, Violation> folder_edges(const House& house);

/// Notes which entries of a table were needed; the others are violations themselves.
class Exceptions {
 public:
  explicit Exceptions(std::span<const Exception> table) : table_(table), used_(table.size()) {}

  /// Is there an entry for the file whose `what` is in `text`?
  bool allow(std::string_view file, std::string_view text);
  void report_unused(Violations& violations) const;

 private:
  std::span<const Exception> table_;
  std::vector<bool> used_;
};

}  // namespace prehend::architecture
