#include <prehend/base/log.hpp>

#include "tool.hpp"

int main(int argc, char** argv) {
  CLI::App app("Tools of the glove.", "prehend glove");
  app.require_subcommand(1);
  prehend::log::set_name("glove");
  int exit_code = 0;
  prehend::glove::add_decode(app, exit_code);
  prehend::glove::add_emulate(app, exit_code);
  prehend::glove::add_calibrate(app, exit_code);
  prehend::glove::add_register(app, exit_code);
  prehend::glove::add_watch(app, exit_code);
  prehend::glove::add_filter_report(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return exit_code;
}
