#include <prehend/base/log.hpp>
#include <prehend/planning/planning_tool.hpp>

#include "tool.hpp"

int main(int argc, char** argv) {
  CLI::App app("What can be said of a grasp.", "prehend grasp");
  app.require_subcommand(1);
  prehend::log::set_name("grasp");
  int exit_code = 0;
  prehend::simulation::add_quality(app, exit_code);
  prehend::simulation::add_plan(app, exit_code);
  prehend::simulation::add_export(app, exit_code);
  prehend::simulation::add_picture(app, exit_code);
  prehend::simulation::add_table(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return exit_code;
}
