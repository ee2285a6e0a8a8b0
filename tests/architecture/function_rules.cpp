// Rules on functions: how long they are, and where those stand that begin a program or add a
// command to it; and what else stands beside main().
#include <algorithm>
#include <optional>

#include "tests/architecture/functions.hpp"
#include "tests/architecture/rules.hpp"
#include "tests/architecture/words.hpp"

namespace prehend::architecture {
namespace {

constexpr int max_function_lines = 60;
constexpr int max_main_lines = 59;

// A comment of its own that says why a function is long.
bool is_reason(std::string_view line) {
  constexpr std::string_view begins = "// Long: ";
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  return line.starts_with(begins) && line.size() > begins.size();
}

// Comments right above it belong to it.
std::size_t begin_with_comments(const File& file, std::size_t begin) {
  const auto is_comment = [](const std::string& line) {
    const auto first = line.find_first_not_of(' ');
    return first != std::string::npos && line.compare(first, 2, "//") == 0;
  };
  while (begin > 0 && is_comment(file.lines[begin - 1])) --begin;
  return begin;
}

// Which function a line belongs to: of those that it is in, the innermost, which comes last.
std::optional<std::size_t> function_at(const File& file, const std::vector<Function>& functions,
                                       std::size_t line) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < functions.size(); ++i)
    if (begin_with_comments(file, functions[i].begin) <= line && line <= functions[i].end)
      found = i;
  return found;
}

int length_of(const Function& function) {
  return static_cast<int>(function.end - function.begin + 1);
}

void check_lengths(const File& file, Exceptions& exceptions, Violations& violations) {
  const std::vector<Function> functions = functions_of(file);
  std::vector<bool> has_reason(functions.size());
  for (std::size_t i = 0; i < file.lines.size(); ++i) {
    if (!is_reason(file.lines[i])) continue;
    const auto of = function_at(file, functions, i);
    if (of && length_of(functions[*of]) > max_function_lines) {
      has_reason[*of] = true;
    } else {
      violations.push_back({file.path, static_cast<int>(i + 1), "says why nothing long is long"});
    }
  }
  for (std::size_t i = 0; i < functions.size(); ++i) {
    const Function& function = functions[i];
    if (length_of(function) <= max_function_lines || has_reason[i] ||
        exceptions.allow(file.path, function.signature))
      continue;
    const std::string head = function.signature.substr(function.column);
    violations.push_back({file.path, static_cast<int>(function.begin + 1),
                          "a function of " + std::to_string(length_of(function)) +
                              " lines: " + head.substr(0, head.find_first_of("{\n"))});
  }
}

// void add_calibrate(tool::Program& program), or int keys_command(const std::vector<std::string>&
// ...)
bool adds_a_command(std::string_view name, std::string_view arguments) {
  return (name.starts_with("add_") && arguments.starts_with("(tool::Program&")) ||
         name.ends_with("_command");
}

// class X {, or struct X final : Y; neither an enum class nor a variable of a struct.
bool is_a_class(const Word& word) {
  if (word.text != "class" && word.text != "struct") return false;
  const std::vector<Word> before = identifiers(word.before), after = identifiers(word.after);
  if (after.empty() || (!before.empty() && before.back().text == "enum")) return false;
  if (after.size() > 1 && after[1].text == "final") return true;
  const std::string_view rest = after.front().after;
  const auto next = rest.find_first_not_of(' ');
  return next == std::string_view::npos || rest[next] == '{' || rest[next] == ':';
}

}  // namespace

Violations broken_functions(const House& house, const Agreed& agreed) {
  Violations violations;
  Exceptions exceptions(agreed.long_functions);
  for (const File& file : house.sources) check_lengths(file, exceptions, violations);
  exceptions.report_unused(violations);
  return violations;
}

Violations overgrown_mains(const House& house, const Agreed&) {
  Violations violations;
  for (const File& file : house.sources) {
    if (!is_main(file)) continue;
    if (const int lines = static_cast<int>(file.lines.size()); lines > max_main_lines)
      violations.push_back({file.path, max_main_lines + 1,
                            "has " + std::to_string(lines) + " lines, at most " +
                                std::to_string(max_main_lines) + " are a main.cpp"});
    for (std::size_t i = 0; i < file.code.size(); ++i)
      for (const Word& word : identifiers(file.code[i]))
        if (is_a_class(word))
          violations.push_back({file.path, static_cast<int>(i + 1),
                                "no test reaches a " + std::string(word.text) + " of a main.cpp"});
  }
  return violations;
}

Violations misnamed_commands(const House& house, const Agreed& agreed) {
  Violations violations;
  Exceptions exceptions(agreed.commands);
  for (const File& file : house.sources) {
    if (!is_of_the_product(file) || !file.path.ends_with(".cpp")) continue;
    const bool is_tool = first_names(file.path, 3).ends_with("/tools");
    for (const Function& function : functions_of(file)) {
      if (function.column > 0) continue;
      const std::string_view signature = function.signature;
      const std::size_t bracket = std::min(signature.find('('), signature.size());
      const std::string_view arguments = signature.substr(bracket);
      const std::vector<Word> words = identifiers(signature.substr(0, bracket));
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
