// The ten lines of Python of the device's page send what the device reads.
#include <arpa/inet.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>

#include "common/base/file_text.hpp"
#include "common/stage/process.hpp"
#include "services/glove/devices/datagrams.hpp"
#include "services/glove/devices/landmark_line.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/glove_devices/listener.hpp"

namespace prehend::glove {
namespace {

/// An open right hand, in metres.
constexpr const char* kit =
    "import random\n"
    "def my_kit():\n"
    "    hand = [(0, 0, 0.3)]\n"
    "    for f in range(5):\n"
    "        for j in range(4):\n"
    "            hand.append((0.02 * f - 0.04, 0.05 + 0.03 * j, 0.3 + 1e-4 * random.random()))\n"
    "    return hand\n";

TEST(LandmarksPage, ItsTenLinesAreUnderstood) {
  const auto page = read_file(test::in_sources("services/glove/devices/landmarks.md"));
  ASSERT_TRUE(page);
  const std::string fence = "```python\n";
  const auto begin = page->find(fence);
  ASSERT_NE(begin, std::string::npos);
  std::string code =
      page->substr(begin + fence.size(), page->find("```", begin + 3) - begin - fence.size());
  const std::string address = testing::free_address();
  const std::string port = address.substr(address.find(':') + 1);
  const auto at = code.find("9870");
  ASSERT_NE(at, std::string::npos);
  code.replace(at, 4, port);
  const auto folder =
      std::filesystem::temp_directory_path() / ("prehend_page_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "kit.py") << kit << code;

  auto receiver = DatagramReceiver::bind({.address = address});
  ASSERT_TRUE(receiver) << receiver.error().message();
  stage::Process::Options options;
  options.command = {"/usr/bin/python3", (folder / "kit.py").string()};
  options.log = folder / "log";
  auto process = stage::Process::start(options);
  ASSERT_TRUE(process) << process.error().message();
  const auto datagram = receiver->read(std::chrono::seconds(30));
  ASSERT_TRUE(datagram) << datagram.error().message();
  const auto line = parse_landmarks(datagram->bytes);
  EXPECT_TRUE(line) << line.error() << read_file(folder / "log").value_or("");
  process->stop(std::chrono::seconds(10));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace prehend::glove
