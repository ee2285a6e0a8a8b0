// The stop on disk: what stands in its place is a stop, whatever it is, and nobody waits for it.
#include "common/robot/kept_stop.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

namespace prehend::robot {
namespace {

namespace fs = std::filesystem;

class KeptStopTest : public testing::Test {
 protected:
  KeptStopTest() {
    folder_ = fs::temp_directory_path() / ("prehend-kept-" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    std::ofstream(folder_ / "lab.toml") << "[safety]\nstate = \"state\"\n[lab]\nrig = \"a/b *\"\n";
    const auto config = service::Config::load(folder_ / "lab.toml");
    kept_.emplace(KeptStop::create(*config, "hand").value());
    EXPECT_TRUE(kept_->keep({"anna", "a noise", from_ns(1'700'000'000'000'000'000)}));
    for (const auto& entry : fs::directory_iterator(folder_ / "state")) file_ = entry.path();
  }
  ~KeptStopTest() override { fs::remove_all(folder_); }

  fs::path folder_, file_;
  std::optional<KeptStop> kept_;
};

TEST_F(KeptStopTest, IsThereUntilItIsForgotten) {
  const auto stop = kept_->recall();
  ASSERT_TRUE(stop);
  EXPECT_EQ(stop->by, "anna");
  EXPECT_EQ(stop->reason, "a noise");
  EXPECT_EQ(stop->since, from_ns(1'700'000'000'000'000'000));
  EXPECT_TRUE(kept_->forget());
  EXPECT_FALSE(kept_->recall());
  EXPECT_TRUE(fs::is_empty(folder_ / "state"));
}

TEST_F(KeptStopTest, WhateverElseIsInItsPlaceIsAStopAndGoesWithTheRelease) {
  const auto is_stop = [&](const char* what) {
    const auto stop = kept_->recall();
    ASSERT_TRUE(stop) << what;
    EXPECT_NE(stop->reason.find("cannot be read"), std::string::npos) << what;
    // A new stop takes its place; the release ends both.
    EXPECT_TRUE(kept_->keep({"ben", "", from_ns(1)})) << what;
    EXPECT_EQ(kept_->recall()->by, "ben") << what;
    EXPECT_TRUE(kept_->forget()) << what;
    EXPECT_FALSE(kept_->recall()) << what;
  };
  fs::remove(file_);
  ASSERT_EQ(::mkfifo(file_.c_str(), 0600), 0);
  is_stop("a pipe, on which one would wait");
  fs::create_symlink(folder_ / "none", file_);
  is_stop("a link that leads nowhere");
  std::ofstream(folder_ / "other") << "mine";
  fs::create_symlink(folder_ / "other", file_);
  is_stop("a link to another file");
  EXPECT_EQ(fs::file_size(folder_ / "other"), 4u) << "which stays as it was";
  std::ofstream(file_).flush();
  is_stop("an empty file");
  std::ofstream(file_) << R"({"stamp_ns":1,"event":"stop")";
  is_stop("half a line");
  std::ofstream(file_) << R"({"stamp_ns":1,"event":"stop","who":"anna"})";
  is_stop("a line without its end");
  std::ofstream(file_) << "x";
  fs::resize_file(file_, std::uintmax_t{1} << 40);
  is_stop("a huge file");
}

TEST_F(KeptStopTest, AFolderInItsPlaceIsAStop) {
  fs::remove(file_);
  fs::create_directories(file_ / "full");
  EXPECT_TRUE(kept_->recall());
  EXPECT_FALSE(kept_->keep({"ben", "", from_ns(1)})) << "and says that it cannot be kept";
}

TEST_F(KeptStopTest, NeedsAFolder) {
  std::ofstream(folder_ / "homeless.toml") << "[lab]\nrig = \"lab\"\n";
  const auto config = service::Config::load(folder_ / "homeless.toml");
  std::map<std::string, std::string> before;
  for (const char* name : {"HOME", "XDG_STATE_HOME", "STATE_DIRECTORY"})
    if (const char* value = std::getenv(name)) {
      before[name] = value;
      ::unsetenv(name);
    }
  const auto kept = KeptStop::create(*config, "hand");
  for (const auto& [name, value] : before) ::setenv(name.c_str(), value.c_str(), 1);
  ASSERT_FALSE(kept);
  EXPECT_EQ(kept.error().what, "names no folder, and there is no home");
}

// What waits beside it is not written into.
TEST_F(KeptStopTest, DoesNotWriteIntoWhatIsBesideIt) {
  const fs::path beside = file_.string() + "." + std::to_string(::getpid());
  ASSERT_EQ(::mkfifo(beside.c_str(), 0600), 0);
  EXPECT_TRUE(kept_->keep({"ben", "", from_ns(1)}));
  std::ofstream(folder_ / "other") << "mine";
  fs::create_symlink(folder_ / "other", beside);
  EXPECT_TRUE(kept_->keep({"carl", "", from_ns(1)}));
  EXPECT_EQ(kept_->recall()->by, "carl");
  EXPECT_EQ(fs::file_size(folder_ / "other"), 4u);
}

}  // namespace
}  // namespace prehend::robot
