#include "tests/architecture/rules.hpp"

#include <array>

namespace prehend::architecture {
namespace {

constexpr std::array all_rules{
    Rule{"includes", "name headers by their path from the root, and keep none that nobody includes",
         broken_includes},
    Rule{"edges", "move what both need further down, or agree on the edge in agreed.hpp",
         broken_edges},
    Rule{"layers", "move it to the layer that may know both", broken_layers},
    Rule{"cores", "let files/, service/ or tools/ do that and hand the core a value", impure_cores},
    Rule{"targets", "say in the folder's CMakeLists.txt what its files include", broken_targets},
    Rule{"namespaces", "open the namespace that the path says", broken_namespaces},
    Rule{"functions", "make smaller ones, or say why not in a comment «Long: ...»",
         broken_functions},
    Rule{"services", "make it like the other services", unlike_services},
    Rule{"root", "put it into the folder that it belongs to", strays_at_the_root},
    Rule{"pages", "mend the page", broken_pages},
    Rule{"words", "use the word of docs/glossary.md", retired_words},
    Rule{"programs", "return an error; only main() ends a program", process_ends_in_libraries},
    Rule{"commands", "a subcommand X is added by X_command.cpp, a program by main.cpp",
         misnamed_commands},
    Rule{"mains", "main() only calls what lies in the library of its folder", overgrown_mains},
};

}  // namespace

std::span<const Rule> rules() {
  return all_rules;
}

std::vector<std::string> violations(const Rule& rule, const House& house, const Agreed& agreed) {
  std::vector<std::string> texts;
  for (const Violation& violation : rule.broken(house, agreed))
    texts.push_back(violation.file + ":" + std::to_string(violation.line) + ": " + violation.what +
                    " (rule " + std::string(rule.name) + ": " + std::string(rule.to_do) + ")");
  return texts;
}

bool Exceptions::allow(std::string_view file, std::string_view text) {
  bool allowed = false;
  for (std::size_t i = 0; i < table_.size(); ++i) {
    if (table_[i].file != file || text.find(table_[i].what) == std::string_view::npos) continue;
    allowed = used_[i] = true;
  }
  return allowed;
}

void Exceptions::report_unused(Violations& violations) const {
  for (std::size_t i = 0; i < table_.size(); ++i)
    if (!used_[i])
      violations.push_back({std::string(table_[i].file), 1,
                            "no longer needs its exception for «" + std::string(table_[i].what) +
                                "»: take it out of " + std::string(agreed_file)});
}

}  // namespace prehend::architecture
