#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <prehend/base/log.hpp>

#include "tool.hpp"

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // we say it ourselves
  CLI::App app("Models of objects for recognition.", "prehend objects");
  app.require_subcommand(1);
  prehend::log::set_name("objects");
  int exit_code = 0;
  prehend::recognition::add_render(app, exit_code);
  prehend::recognition::add_train(app, exit_code);
  prehend::recognition::add_add(app, exit_code);
  prehend::recognition::add_detect(app, exit_code);
  prehend::recognition::add_evaluate(app, exit_code);
  prehend::recognition::add_scenes(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return exit_code;
}
