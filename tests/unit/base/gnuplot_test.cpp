// Pictures by gnuplot: a script of that name, put in front of the others, stands for it.
#include "common/base/gnuplot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

namespace prehend {
namespace {

TEST(Gnuplot, SaysWhyThereIsNoPicture) {
  const auto folder =
      std::filesystem::path(testing::TempDir()) / ("gnuplot" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", folder.c_str(), 1);
  const auto refused = [&](const std::string& script, const std::string& png) {
    if (!script.empty()) {
      std::ofstream(folder / "gnuplot") << "#!/bin/sh\n" << script << "\n";
      std::filesystem::permissions(folder / "gnuplot", std::filesystem::perms::owner_all);
    }
    const auto drawn = draw_by_gnuplot("plot x", png, 640, 480);
    return drawn ? "drawn" : drawn.error().message();
  };
  EXPECT_THAT(refused("", "a.png"), testing::HasSubstr("gnuplot cannot be run: "));
  EXPECT_THAT(refused("exit 1", "a.png"),
              testing::HasSubstr("a.png: gnuplot did not draw the picture"));
  const std::string draws = ": >\"${1%script}drawn.png\"";
  EXPECT_THAT(refused(draws, "/nowhere/a.png"),
              testing::HasSubstr("/nowhere/a.png: cannot be written: "));
  EXPECT_EQ(refused(draws, (folder / "a.png").string()), "drawn");
  ::setenv("PATH", path.c_str(), 1);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace prehend
