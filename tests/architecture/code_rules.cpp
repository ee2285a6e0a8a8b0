// Rules on what stands in a source: namespaces, and calls that end a process.
#include <algorithm>
#include <array>

#include "tests/architecture/rules.hpp"
#include "tests/architecture/words.hpp"

namespace prehend::architecture {
namespace {

// prehend::dds of common/dds/raw.hpp; what lies in common/base is prehend itself.
std::string namespace_of(std::string_view path) {
  const std::string top = first_names(path, 2);
  return top == "common/base" ? "prehend" : "prehend::" + top.substr(top.find('/') + 1);
}

constexpr std::array process_endings{"exit", "_exit", "_Exit", "quick_exit", "abort"};

bool ends_the_process(const Word& word) {
  if (std::find(process_endings.begin(), process_endings.end(), word.text) == process_endings.end())
    return false;
  if (!word.after.starts_with("(")) return false;
  std::string_view before = word.before;
  if (before.ends_with(".") || before.ends_with("->")) return false;  // of one of our own classes
  if (before.ends_with("::")) {
    before.remove_suffix(2);
    return before.ends_with("std") || before.empty() || !is_word_character(before.back());
  }
  // Our own are called without an argument, exit(int) is not.
  return word.text != "exit" || !word.after.starts_with("()");
}

bool is_in_a_library(const File& file) {
  if (is_main(file)) return false;
  return file.path.starts_with("common/") ||
         (file.path.starts_with("services/") && !first_names(file.path, 3).ends_with("/tools"));
}

}  // namespace

Violations broken_namespaces(const House& house, const Agreed&) {
  Violations violations;
  for (const File& file : house.sources) {
    if (!is_of_the_product(file) || is_main(file)) continue;
    const std::string own = namespace_of(file.path);
    bool opened = false;
    for (std::size_t i = 0; i < file.code.size(); ++i) {
      const std::vector<std::string> words = words_of(file.code[i].substr(0, 200));
      if (!file.code[i].starts_with("namespace ") || words.size() < 2) continue;
      if (words[1] == own || words[1].starts_with(own + "::")) {
        opened = true;
      } else if (words[1] == "prehend" || words[1].starts_with("prehend::")) {
        violations.push_back({file.path, static_cast<int>(i + 1), "opens " + words[1]});
      }
    }
    if (!opened) violations.push_back({file.path, 1, "does not open " + own});
  }
  return violations;
}

Violations process_ends_in_libraries(const House& house, const Agreed& agreed) {
  Violations violations;
  Exceptions exceptions(agreed.ends);
  for (const File& file : house.sources) {
    if (!is_in_a_library(file)) continue;
    for (std::size_t i = 0; i < file.code.size(); ++i)
      for (const Word& word : identifiers(file.code[i]))
        if (ends_the_process(word) && !exceptions.allow(file.path, word.text))
          violations.push_back({file.path, static_cast<int>(i + 1),
                                "a library ends the process: " + std::string(word.text)});
  }
  exceptions.report_unused(violations);
  return violations;
}

}  // namespace prehend::architecture
