#include "common/tool/program.hpp"

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>
#include <string_view>
#include <utility>

#include "common/base/finite_number.hpp"
#include "common/base/log.hpp"
#include "common/base/log_format.hpp"
#include "common/base/printable.hpp"
#include "common/tool/output.hpp"

namespace prehend::tool {

int complain(const Error& error) {
  return complain(error, error.exit);
}

int complain(const Error& error, int exit_code) {
  if (!error.message().empty()) log::error(error);
  return exit_code;
}

namespace {

constexpr const char* log_variable = "PREHEND_LOG";
constexpr std::string_view log_option = "--log";

/// The option is looked for without parsing: what is wrong with the arguments is to be said as it
/// demands.
std::optional<log::Format> format_in(const std::vector<std::string>& arguments) {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string_view text = arguments[i];
    if (text == log_option && i + 1 < arguments.size()) return log::format_of(arguments[i + 1]);
    if (text.starts_with("--log=")) return log::format_of(text.substr(6));
  }
  return std::nullopt;
}

/// What is read here was chosen already; CLI11 only lists and checks it.
void add_log_option(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
    add_log_option(*command);
  if (app.get_option_no_throw(std::string(log_option))) return;
  app.add_option(std::string(log_option), "lines of the log: text, or json with one object a line")
      ->envname(log_variable)
      ->check(CLI::IsMember({"text", "json"}));
}

/// Empty: the word is what an option that shows this type takes. A whole number loses its leading
/// zeros, which CLI11 would take for base eight.
std::string check_number(std::string_view type, std::string& word) {
  if (type.starts_with("FLOAT")) return finite_number(word) ? "" : no_finite_number(word);
  if (word.empty()) return "is empty, a whole number is wanted";
  const std::size_t sign = word[0] == '-' || word[0] == '+' ? 1 : 0;
  const std::size_t digits = word.find_first_not_of('0', sign);
  if (word.size() == sign || word.find_first_not_of("0123456789", sign) != std::string::npos)
    return printable(word) + " is no whole number, write it in digits, without a unit";
  if (type.starts_with("UINT") && word[0] == '-') return word + " is less than 0";
  const std::string rest = digits == std::string::npos ? "0" : word.substr(digits);
  if (rest.size() > 20) return word + " is too large";
  word = (word[0] == '-' ? "-" : "") + rest;
  return {};
}

/// Every option that takes numbers takes finite ones: CLI11 itself reads nan, inf and 1e309, which
/// pass its ranges, and takes an empty word for 0.
void check_numbers(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
    check_numbers(*command);
  for (CLI::Option* option : app.get_options()) {
    const std::string type = option->get_type_name();
    if (!type.starts_with("FLOAT") && !type.starts_with("INT") && !type.starts_with("UINT"))
      continue;
    option->transform(CLI::Validator([type](std::string& word) { return check_number(type, word); },
                                     std::string()));
  }
}

}  // namespace

void choose_log(const std::vector<std::string>& arguments) {
  auto format = format_in(arguments);
  if (format) ::setenv(log_variable, *format == log::Format::json ? "json" : "text", 1);
  if (const char* text = std::getenv(log_variable); text && !format) format = log::format_of(text);
  log::set_format(format.value_or(log::Format::text));
}

std::optional<int> parse(CLI::App& app, const std::vector<std::string>& arguments) {
  choose_log(arguments);
  add_log_option(app);
  check_numbers(app);
  // CLI11 wants them last first.
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  try {
    app.parse(reversed);
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help();
    return exit_done;
  } catch (const CLI::ParseError& error) {
    return complain({error.what(), app.get_name(), "see --help"}, exit_wrong_use);
  }
  return std::nullopt;
}

std::optional<int> parse(CLI::App& app, int argc, char** argv) {
  return parse(app, {argv + 1, argv + argc});
}

Program::Program(const std::string& name, const std::string& description)
    : app_(std::make_unique<CLI::App>(description, "prehend " + name)) {
  app_->require_subcommand(1);
  log::set_name(name);
}

void Program::on(CLI::App& command, std::function<int()> run) {
  command.callback([this, run = std::move(run)] { exit_code_ = run(); });
}

Program::~Program() = default;

int Program::run(int argc, char** argv) {
  return with_whole_output([&] {
    const auto ended = parse(*app_, argc, argv);
    return ended ? *ended : exit_code_;
  });
}

}  // namespace prehend::tool
