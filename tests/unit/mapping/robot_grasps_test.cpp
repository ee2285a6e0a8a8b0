// The robot's grasps are data (services/mapping/trained): closing a hand takes a minute or more and
// always comes to the same bytes. Here it is done again: for the hand that takes least by default,
// for all in the long round. Byte for byte on the release on which the files were made, Debian 12;
// another compiler may round differently.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "services/mapping/tools/training/closures.hpp"
#include "tests/support/hands.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::mapping {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

bool is_debian_12() {
  return bytes_of("/etc/os-release").find("VERSION_CODENAME=bookworm") != std::string::npos;
}

std::vector<std::string> hands_to_close() {
  std::vector<std::string> hands{"parallel_jaw"};
  if (std::getenv("PREHEND_LONG")) hands = test::mappable_hands();
  return hands;
}

TEST(RobotGrasps, AreThoseThatClosingMakes) {
  if (!is_debian_12()) GTEST_SKIP() << "the grasps were made on Debian 12";
  const fs::path folder = fs::temp_directory_path() / ("grasps-" + std::to_string(getpid()));
  fs::create_directories(folder);
  for (const std::string& name : hands_to_close()) {
    const fs::path source = test::in_sources(""), made = folder / (name + ".grasps");
    const model::HandModel& hand = test::hand(name);
    const auto scheme = Scheme::load(source / "services/mapping/schemes" / (name + ".toml"), hand);
    ASSERT_TRUE(scheme) << scheme.error().message();
    const auto grasps =
        close_and_save(hand, *scheme, source / "common/models/objects/catalogue.toml", made);
    ASSERT_TRUE(grasps) << grasps.error().message();
    EXPECT_GT(grasps->size(), 0u);
    EXPECT_TRUE(bytes_of(made) ==
                bytes_of(source / "services/mapping/trained" / (name + ".grasps")))
        << name
        << ": closing the hand came to other grasps; if that is meant: prehend train --hand "
        << name << " --close --grasps services/mapping/trained/" << name << ".grasps";
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace prehend::mapping
