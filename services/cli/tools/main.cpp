#include <iostream>

#include "common/tool/output.hpp"
#include "common/tool/program.hpp"
#include "services/cli/tools/commands.hpp"

int main(int argc, char** argv) {
  using namespace prehend;
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  tool::choose_log(arguments);
  return tool::with_whole_output([&]() -> int {
    if (arguments.empty() || arguments.front() == "--help" || arguments.front() == "-h") {
      (arguments.empty() ? std::cerr : std::cout) << cli::help();
      return arguments.empty() ? exit_wrong_use : exit_done;
    }
    if (arguments.front() == "--version") {
      std::cout << "prehend " PREHEND_VERSION "\n";
      return exit_done;
    }
    return cli::run(arguments);
  });
}
