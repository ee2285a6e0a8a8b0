#include <prehend/base/log.hpp>

#include "tool.hpp"

int main(int argc, char** argv) {
  CLI::App app("Any URDF as a hand of the lab.", "prehend hand");
  app.require_subcommand(1);
  prehend::log::set_name("hand");
  int exit_code = 0;
  prehend::hands::add_check(app, exit_code);
  prehend::hands::add_add(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return exit_code;
}
