#include "services/cli/tools/hello_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>

#include "services/cli/tools/arguments.hpp"

namespace prehend::cli {

int hello_command(const std::vector<std::string>& arguments) {
  CLI::App app{"Says hello.", "prehend hello"};
  std::string name = "world";
  app.add_option("--name", name, "to whom")->capture_default_str();
  if (const auto code = parse(app, arguments)) return *code;
  std::cout << "hello " << name << '\n';
  return exit_done;
}

}  // namespace prehend::cli
