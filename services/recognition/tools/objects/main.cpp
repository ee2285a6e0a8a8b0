#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>

#include "services/recognition/tools/objects/commands.hpp"

int main(int argc, char** argv) {
  using namespace prehend::recognition;
  cv::setNumThreads(1);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // we say it ourselves
  prehend::tool::Program program("objects", "Models of objects for recognition.");
  add_render(program);
  add_train(program);
  add_add(program);
  add_detect(program);
  add_evaluate(program);
  add_scenes(program);
  return program.run(argc, argv);
}
