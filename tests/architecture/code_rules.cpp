// Rules on what stands in a source: namespaces, lengths, words, calls.
#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include "tests/architecture/rules.hpp"

namespace prehend::architecture {
namespace {

constexpr int max_function_lines = 60;

bool is_of_the_product(const File& file) {
  return file.path.starts_with("common/") || file.path.starts_with("services/");
}

bool is_main(const File& file) {
  return file.path.ends_with("/main.cpp");
}

// prehend::dds of common/dds/raw.hpp; what lies in common/base is prehend itself.
std::string namespace_of(std::string_view path) {
  const std::string top = first_names(path, 2);
  return top == "common/base" ? "prehend" : "prehend::" + top.substr(top.find('/') + 1);
}

bool is_word_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
}

/// An identifier in a line of code.
struct Word {
  std::string_view text;
  std::string_view before, after;  // the rest of the line
};

std::vector<Word> identifiers(std::string_view line) {
  std::vector<Word> words;
  for (std::size_t i = 0; i < line.size();) {
    if (!is_word_character(line[i])) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < line.size() && is_word_character(line[end])) ++end;
    words.push_back({line.substr(i, end - i), line.substr(0, i), line.substr(end)});
    i = end;
  }
  return words;
}

/// Lines from the first of the signature to the bracket that closes it.
struct Function {
  std::size_t begin = 0, end = 0;
  std::string signature;
};

bool begins_a_declaration(std::string_view line) {
  return !line.empty() && (is_word_character(line[0]) || line[0] == ':' || line[0] == '[');
}

bool begins_a_function(const std::string& signature) {
  if (signature.find('(') == std::string::npos) return false;
  for (const Word& word : identifiers(signature.substr(0, signature.find('('))))
    for (const char* other : {"namespace", "struct", "class", "enum", "union", "extern"})
      if (word.text == other) return false;
  return true;
}

// Code is formatted: what begins in column 0 ends there.
std::vector<Function> functions_of(const File& file) {
  std::vector<Function> functions;
  for (std::size_t i = 0; i < file.code.size(); ++i) {
    if (!begins_a_declaration(file.code[i])) continue;
    Function function{i, i, {}};
    char last = ' ';
    for (; function.end < file.code.size(); ++function.end) {
      const std::string& line = file.code[function.end];
      function.signature += line + "\n";
      const auto end = line.find_last_not_of(' ');
      last = end == std::string::npos ? ' ' : line[end];
      if (last == '{' || last == ';' || last == '}') break;
    }
    if (last == '{' && begins_a_function(function.signature)) {
      while (++function.end < file.code.size() && !file.code[function.end].starts_with("}")) {
      }
      functions.push_back(function);
      i = function.end;
    } else {
      i = std::max(i, function.end);
    }
  }
  return functions;
}

// Says somebody, above it or in it, why it is long?
bool says_why_long(const File& file, const Function& function) {
  std::size_t begin = function.begin;
  while (begin > 0 && file.lines[begin - 1].starts_with("//")) --begin;
  const std::size_t end = std::min(function.end, file.lines.size());
  return std::any_of(file.lines.begin() + begin, file.lines.begin() + end,
                     [](const std::string& line) {
                       const auto comment = line.find("// Long: ");
                       return comment != std::string::npos && comment + 9 < line.size();
                     });
}

constexpr std::array retired_names{"RightOfWay", "DeafnessWatch", "BetweenSites", "LearntPlace"};
constexpr std::array retired_prefixes{"most_", "least_", "longest_"};

bool is_retired(std::string_view word) {
  if (word == "least_torques") return false;  // a function of common/analysis
  return std::any_of(retired_names.begin(), retired_names.end(),
                     [&](std::string_view name) { return word == name; }) ||
         std::any_of(retired_prefixes.begin(), retired_prefixes.end(),
                     [&](std::string_view prefix) { return word.starts_with(prefix); });
}

// What lies on disk keeps its names.
bool is_of_protobuf(const Word& word) {
  return word.before.ends_with("messages::") ||
         ((word.before.ends_with(".") || word.before.ends_with("->")) &&
          word.after.starts_with("("));
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

// void add_calibrate(tool::Program& program), or int keys_command(const std::vector<std::string>&
// ...)
bool adds_a_command(std::string_view name, std::string_view arguments) {
  return (name.starts_with("add_") && arguments.starts_with("(tool::Program&")) ||
         name.ends_with("_command");
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

Violations broken_functions(const House& house, const Agreed& agreed) {
  Violations violations;
  Exceptions exceptions(agreed.long_functions);
  for (const File& file : house.sources)
    for (const Function& function : functions_of(file)) {
      const auto length = static_cast<int>(function.end - function.begin + 1);
      if (length <= max_function_lines || says_why_long(file, function) ||
          exceptions.allow(file.path, function.signature))
        continue;
      violations.push_back(
          {file.path, static_cast<int>(function.begin + 1),
           "a function of " + std::to_string(length) +
               " lines: " + function.signature.substr(0, function.signature.find_first_of("{\n"))});
    }
  exceptions.report_unused(violations);
  return violations;
}

Violations retired_words(const House& house, const Agreed&) {
  Violations violations;
  for (const File& file : house.sources)
    for (std::size_t i = 0; i < file.code.size(); ++i)
      for (const Word& word : identifiers(file.code[i]))
        if (is_retired(word.text) && !is_of_protobuf(word))
          violations.push_back(
              {file.path, static_cast<int>(i + 1), "says " + std::string(word.text)});
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

Violations misnamed_commands(const House& house, const Agreed& agreed) {
  Violations violations;
  Exceptions exceptions(agreed.commands);
  for (const File& file : house.sources) {
    if (!is_of_the_product(file) || !file.path.ends_with(".cpp")) continue;
    const bool is_tool = first_names(file.path, 3).ends_with("/tools");
    for (const Function& function : functions_of(file)) {
      const std::string_view signature = function.signature;
      const std::string_view arguments = signature.substr(signature.find('('));
      const std::vector<Word> words = identifiers(signature.substr(0, signature.find('(')));
      if (words.empty()) continue;
      const std::string_view name = words.back().text;
      const int line = static_cast<int>(function.begin + 1);
      if (name == "main") {
        if (!is_main(file)) violations.push_back({file.path, line, "main() is not in main.cpp"});
      } else if (is_tool && adds_a_command(name, arguments) &&
                 !file.path.ends_with("_command.cpp") && !exceptions.allow(file.path, name)) {
        violations.push_back({file.path, line, std::string(name) + " adds a subcommand"});
      }
    }
  }
  exceptions.report_unused(violations);
  return violations;
}

}  // namespace prehend::architecture
