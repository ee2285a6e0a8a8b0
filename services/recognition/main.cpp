#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>

#include "service.hpp"

int main(int argc, char** argv) {
  cv::setNumThreads(1);  // a pool of threads would cost memory and win nothing at this size
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // we say it ourselves
  int exit_code = 0;
  const auto shell = prehend::service::Shell::create(
      argc, argv,
      {"recognition", "Recognises objects in a camera's pictures and says where they stand."},
      exit_code);
  if (!shell) return exit_code;
  return prehend::recognition::run_service(*shell);
}
