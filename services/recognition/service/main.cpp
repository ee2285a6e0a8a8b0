#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>

#include "common/service/life_cycle.hpp"
#include "services/recognition/service/service.hpp"

int main(int argc, char** argv) {
  cv::setNumThreads(1);  // a pool of threads would cost memory and win nothing at this size
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);  // we say it ourselves
  return prehend::service::run<prehend::recognition::Service>(
      argc, argv,
      {.name = "recognition",
       .description = "Recognises objects in a camera's pictures and says where they stand."});
}
