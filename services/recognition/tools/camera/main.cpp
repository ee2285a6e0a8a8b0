#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>

#include "services/recognition/tools/camera/commands.hpp"

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // we say it ourselves
  prehend::tool::Program program("camera", "Tools of the camera.");
  prehend::recognition::add_calibrate(program);
  prehend::recognition::add_sources(program);
  return program.run(argc, argv);
}
