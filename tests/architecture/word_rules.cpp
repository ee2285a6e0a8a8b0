// Names that were given up do not come back: not in code, not as the name of a file.
#include <algorithm>
#include <array>
#include <cctype>

#include "tests/architecture/rules.hpp"
#include "tests/architecture/words.hpp"

namespace prehend::architecture {
namespace {

constexpr std::array retired_prefixes{"most_", "least_", "longest_"};

constexpr std::string_view glossary = "docs/glossary.md";

// right_of_way of RightOfWay.
std::string snake_case(std::string_view name) {
  std::string text;
  for (const char c : name) {
    const bool begins = std::isupper(static_cast<unsigned char>(c)) != 0;
    if (begins && !text.empty()) text += '_';
    text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text;
}

bool has_several_words(const Retired& retired) {
  return snake_case(retired.was).find('_') != std::string::npos;
}

bool is_type(std::string_view name) {
  return std::isupper(static_cast<unsigned char>(name.front())) != 0;
}

// Where another meaning of the word is at home, it may stand.
bool holds_for(const Retired& retired, std::string_view path) {
  return retired.where.empty() ||
         ("/" + std::string(path)).find("/" + std::string(retired.where) + "/") !=
             std::string::npos;
}

// Several words are found in longer names and as variables, too. One word is also plain English:
// it is one only as a type, or at its end (FilterFigures), and a function only as it is called.
bool says(const Word& word, const Retired& retired) {
  if (has_several_words(retired))
    return word.text.find(retired.was) != std::string_view::npos ||
           word.text.find(snake_case(retired.was)) != std::string_view::npos;
  if (is_type(retired.was)) return word.text.ends_with(retired.was);
  return word.text == retired.was && word.after.starts_with("(");
}

bool has_retired_prefix(std::string_view word) {
  if (word == "least_torques") return false;  // a function of common/analysis
  return std::any_of(retired_prefixes.begin(), retired_prefixes.end(),
                     [&](std::string_view prefix) { return word.starts_with(prefix); });
}

// What lies on disk keeps its names.
bool is_of_protobuf(const Word& word) {
  return word.before.ends_with("messages::") ||
         ((word.before.ends_with(".") || word.before.ends_with("->")) &&
          word.after.starts_with("("));
}

// arrival of tests/unit/mapping/arrival_test.cpp, also of a folder.
std::string_view stem_of(std::string_view path) {
  path.remove_prefix(path.rfind('/') + 1);  // npos + 1 is 0
  path = path.substr(0, path.find('.'));
  if (path.ends_with("_test")) path.remove_suffix(5);
  return path;
}

bool is_named(std::string_view path, const Retired& retired) {
  const std::string name = snake_case(retired.was);
  const std::string_view stem = stem_of(path);
  return has_several_words(retired) ? stem.find(name) != std::string_view::npos : stem == name;
}

std::string instead(const Retired& retired) {
  return std::string(retired.was) + ", which is " + std::string(retired.is) + " now";
}

void check_code(const File& file, const Agreed& agreed, Violations& violations) {
  for (std::size_t i = 0; i < file.code.size(); ++i)
    for (const Word& word : identifiers(file.code[i])) {
      const int line = static_cast<int>(i + 1);
      if (has_retired_prefix(word.text) && !is_of_protobuf(word))
        violations.push_back({file.path, line, "says " + std::string(word.text)});
      for (const Retired& retired : agreed.retired)
        if (says(word, retired) && holds_for(retired, file.path) &&
            !word.before.ends_with("messages::"))
          violations.push_back({file.path, line, "says " + instead(retired)});
    }
}

// «(was X)» in the glossary.
void check_glossary(const File& page, const Agreed& agreed, Violations& violations) {
  constexpr std::string_view was = "(was ";
  for (std::size_t i = 0; i < page.lines.size(); ++i) {
    const std::string_view line = page.lines[i];
    const auto at = line.find(was);
    if (at == std::string_view::npos) continue;
    const std::vector<Word> words = identifiers(line.substr(at + was.size()));
    if (words.empty() ||
        std::any_of(agreed.retired.begin(), agreed.retired.end(),
                    [&](const Retired& retired) { return retired.was == words.front().text; }))
      continue;
    violations.push_back({page.path, static_cast<int>(i + 1),
                          std::string(words.front().text) + " was given up, but " +
                              std::string(agreed_file) + " does not know it"});
  }
}

}  // namespace

Violations retired_words(const House& house, const Agreed& agreed) {
  Violations violations;
  for (const File& file : house.sources) check_code(file, agreed, violations);
  for (const std::string& path : house.paths)
    for (const Retired& retired : agreed.retired)
      if (is_named(path, retired) && holds_for(retired, path))
        violations.push_back({path, 1, "is called by " + instead(retired)});
  for (const File& page : house.pages)
    if (page.path == glossary) check_glossary(page, agreed, violations);
  return violations;
}

}  // namespace prehend::architecture
