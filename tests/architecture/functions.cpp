#include "tests/architecture/functions.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "tests/architecture/words.hpp"

namespace prehend::architecture {
namespace {

// What has a bracket and a brace, too: statements begin with these, types have them in their head.
constexpr std::array<std::string_view, 12> statements{"if",    "else",   "for",    "while",
                                                      "do",    "try",    "switch", "case",
                                                      "catch", "return", "throw",  "default"};
constexpr std::array<std::string_view, 6> types{"namespace", "struct", "class",
                                                "enum",      "union",  "extern"};

template <class List>
bool is_one_of(std::string_view word, const List& list) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

std::size_t column_of(std::string_view line) {
  return std::min(line.find_first_not_of(' '), line.size());
}

// public: and the like.
bool is_label(std::string_view line) {
  const std::string_view word = line.substr(column_of(line));
  const auto end = std::find_if_not(word.begin(), word.end(), is_word_character);
  return end != word.begin() &&
         word.substr(static_cast<std::size_t>(end - word.begin())).starts_with(":") &&
         word.find_first_not_of(' ', static_cast<std::size_t>(end - word.begin()) + 1) ==
             std::string_view::npos;
}

bool begins_a_declaration(std::string_view line) {
  const std::size_t column = column_of(line);
  if (column == line.size() || is_label(line)) return false;
  const char first = line[column];
  return is_word_character(first) || first == ':' || first == '[' || first == '~';
}

// Without template <...> before it, which may say «class».
std::string_view without_template(std::string_view signature) {
  signature.remove_prefix(column_of(signature));
  if (!signature.starts_with("template")) return signature;
  int depth = 0;
  for (std::size_t i = signature.find('<'); i < signature.size(); ++i) {
    if (signature[i] == '<') ++depth;
    if (signature[i] == '>' && --depth == 0) return signature.substr(i + 1);
  }
  return signature;
}

// Where arguments begin, or a lambda, which need not have any; but not the [] of an array.
std::size_t bracket_of(std::string_view signature) {
  for (std::size_t i = 0; i < signature.size(); ++i)
    if (signature[i] == '(' ||
        (signature[i] == '[' && (i == 0 || !is_word_character(signature[i - 1]))))
      return i;
  return std::string_view::npos;
}

bool begins_a_function(std::string_view signature) {
  signature = without_template(signature);
  const auto bracket = bracket_of(signature);
  if (bracket == std::string_view::npos) return false;
  const std::vector<Word> head = identifiers(signature.substr(0, bracket));
  if (!head.empty() && is_one_of(head.front().text, statements)) return false;
  return std::none_of(head.begin(), head.end(),
                      [](const Word& word) { return is_one_of(word.text, types); });
}

// The line of the brace that closes the one with which line `begin` ends.
std::size_t end_of_body(const std::vector<std::string>& code, std::size_t begin) {
  int depth = 1;
  for (std::size_t i = begin + 1; i < code.size(); ++i)
    for (const char c : code[i]) {
      if (c == '{') ++depth;
      if (c == '}' && --depth == 0) return i;
    }
  return code.size();
}

}  // namespace

std::vector<Function> functions_of(const File& file) {
  std::vector<Function> functions;
  for (std::size_t i = 0; i < file.code.size(); ++i) {
    if (!begins_a_declaration(file.code[i])) continue;
    Function function{i, i, column_of(file.code[i]), {}};
    char last = ' ';
    for (; i < file.code.size(); ++i) {
      const std::string& line = file.code[i];
      function.signature += line + "\n";
      const auto end = line.find_last_not_of(' ');
      last = end == std::string::npos ? ' ' : line[end];
      if (last == '{' || last == ';' || last == '}') break;
    }
    if (last != '{' || !begins_a_function(function.signature)) continue;
    function.end = end_of_body(file.code, i);
    functions.push_back(std::move(function));
  }
  return functions;
}

}  // namespace prehend::architecture
