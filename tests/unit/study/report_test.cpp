#include "services/mapping/tools/study/report.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

namespace prehend::mapping {
namespace {

TEST(Report, SaysWhichFileCannotBeWritten) {
  const auto folder =
      std::filesystem::path(testing::TempDir()) / ("report" + std::to_string(getpid()));
  std::filesystem::create_directories(folder / "report.html");  // a folder is there
  EXPECT_EQ(write_report(folder, {}, {}, {}).error().message(),
            (folder / "report.html").string() + ": cannot be written");
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace prehend::mapping
