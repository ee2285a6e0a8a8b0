// A lab of processes is ended so that who listens hears the last words of the others.
#include "common/stage/lab.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <thread>

#include "common/stage/temporary_folder.hpp"

namespace prehend::stage {
namespace {

void await(const std::filesystem::path& file) {
  while (!std::filesystem::exists(file)) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

// A recorder that ended beside the simulation missed the grasp's report, twice in fifteen times in
// a lab with keys.
TEST(Lab, TheFirstThatWasStartedEndsLast) {
  const auto folder = TemporaryFolder::create(false);
  ASSERT_TRUE(folder);
  const std::filesystem::path said = folder->path() / "said", heard = folder->path() / "heard";
  Lab lab("", {}, folder->path());
  const auto start = [&](const std::string& name, const std::string& at_the_end) {
    const std::filesystem::path ready = folder->path() / (name + "-ready");
    ASSERT_TRUE(lab.start(name, "/bin/sh",
                          {"-c", "trap '" + at_the_end + "; exit 0' TERM; touch " + ready.string() +
                                     "; while :; do sleep 0.02; done"}));
    await(ready);
  };
  start("recorder", "test -e " + said.string() + " && touch " + heard.string());
  start("simulation", "sleep 0.2; touch " + said.string());
  lab.stop();
  EXPECT_TRUE(std::filesystem::exists(said));
  EXPECT_TRUE(std::filesystem::exists(heard));
}

}  // namespace
}  // namespace prehend::stage
