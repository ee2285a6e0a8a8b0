// What the configuration may not say of a console is refused by the name of its key or file.
#include "services/console/service/setup.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "common/base/file_text.hpp"
#include "services/console/service/glove_line.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::console {
namespace {

/// What is said of a lab with that setting.
std::string setup_said(const std::string& setting) {
  const auto config = service::Config::load(test::in_sources("deploy/lab.toml"),
                                            {"glove.device=landmarks", setting});
  if (!config) return config.error().message();
  if (const auto made = server_options(*config); !made) return made.error().message();
  if (const auto made = policy_of(*config); !made) return made.error().message();
  if (const auto made = console::pose_of(*config, "tracker.X_WT"); !made)
    return made.error().message();
  if (const auto made = GloveLine::create(*config); !made) return made.error().message();
  return "taken";
}

TEST(ConsoleSetup, IsRefusedByItsKeys) {
  const auto folder =
      std::filesystem::path(::testing::TempDir()) / ("tokens" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const auto token = [&](const std::string& line) {
    const auto file = folder / std::to_string(line.size());
    EXPECT_TRUE(write_file(file, line + "\nanother line\n"));
    return "console.token_file=" + file.string();
  };
  for (const auto& [setting, words] :
       {std::pair<std::string, std::string>(token("a-token_of-the-lab"), "taken"),
        {token("fifteen-letters"), "/15: its first line is no token (16 or more letters"},
        {token("with a space in the line"), "/24: its first line is no token (16 or more letters"},
        {"console.port=65536", "console.port: is no port (0 to 65535)"},
        {"console.port=-1", "console.port: is no port (0 to 65535)"},
        {"tracker.X_WT=[0, 0, 0]",
         "tracker.X_WT: needs seven numbers: x y z in m, then the quaternion w x y z"},
        {"tracker.X_WT=[1, 1, 1, 0, 0, 0, 0]", "tracker.X_WT: rotation has zero norm"},
        {"glove.port=9870", "glove.port = 9870: cannot be sent to (give HOST:PORT)"}})
    EXPECT_THAT(setup_said(setting), ::testing::HasSubstr(words)) << setting;
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace prehend::console
