// A tool that changes one line of a person's file leaves the rest of it alone.
#include "common/base/toml_text.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

namespace prehend {
namespace {

TEST(TomlText, ReplacesTheLineInItsTableOnly) {
  const std::string before =
      "focal = 1\n[camera]  # ours\n  focal = [1, 2] # old\nfocal_length = 3\n[other]\nfocal = 4\n";
  EXPECT_EQ(with_line(before, "camera", "focal", "focal = [5, 6]"),
            "focal = 1\n[camera]  # ours\nfocal = [5, 6]\nfocal_length = 3\n[other]\nfocal = 4\n");
}

TEST(TomlText, AddsWhatIsMissing) {
  EXPECT_EQ(with_line("[camera]\nwidth = 1\n", "camera", "focal", "focal = 2"),
            "[camera]\nfocal = 2\nwidth = 1\n");
  EXPECT_EQ(with_line("a = 1", "camera", "focal", "focal = 2"), "a = 1\n\n[camera]\nfocal = 2\n");
  EXPECT_EQ(with_line("[camera]\nk = 1\nk = 2\n", "camera", "k", "k = 3"), "[camera]\nk = 3\n");
}

TEST(TomlText, FileIsChangedInPlaceOrNotAtAll) {
  const auto file = std::filesystem::temp_directory_path() / ("toml" + std::to_string(getpid()));
  std::ofstream(file) << "[camera]\nfocal = 1\n";
  EXPECT_TRUE(write_line(file, "camera", "focal", "focal = 2"));
  std::ifstream in(file);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "[camera]\nfocal = 2\n");
  std::filesystem::remove(file);
  EXPECT_FALSE(write_line(file, "camera", "focal", "focal = 2"));
}

}  // namespace
}  // namespace prehend
