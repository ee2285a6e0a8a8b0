// Lines of the log: a full date on each, and as JSON one object a line, whatever the words are.
#include "common/base/log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "common/base/log_format.hpp"

namespace prehend {
namespace {

using namespace std::string_literals;
using Json = nlohmann::json;

constexpr const char* date = "^2[0-9]{3}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}\\.[0-9]{3}Z";

class Log : public testing::Test {
 protected:
  ~Log() override {
    log::set_format(log::Format::text);
    log::set_name("");
    log::set_rig("");
    log::set_verbose(false);
  }
  template <class Write>
  static std::vector<std::string> lines(Write write) {
    testing::internal::CaptureStderr();
    write();
    std::istringstream said(testing::internal::GetCapturedStderr());
    std::vector<std::string> all;
    for (std::string line; std::getline(said, line);) all.push_back(line);
    return all;
  }
};

TEST_F(Log, ATextLineHasDateAndZone) {
  log::set_name("glove");
  const auto said = lines([] { log::warning("port {} is silent", 7); });
  ASSERT_EQ(said.size(), 1u);
  EXPECT_THAT(said[0], testing::ContainsRegex(date));
  EXPECT_THAT(said[0], testing::EndsWith("Z warning [glove] port 7 is silent"));
}

TEST_F(Log, EveryTextIsOneJsonObjectOnOneLine) {
  log::set_format(log::Format::json);
  log::set_name("glove \"left\"");
  log::set_rig("cell\n1");
  const std::string texts[] = {"plain"s,
                               ""s,
                               "a \"quoted\" word and a \\"s,
                               "first\nsecond\r\n\tthird"s,
                               "\x1b[2J\a\0\x7f"s,
                               "12 µs ± 3 °C, 手, 🤖, \xc2\x9b"s,
                               "{\"level\":\"error\"}"s,
                               "%v %l {} {0}"s};
  for (const std::string& text : texts) {
    const auto said = lines([&] { log::info("{}", text); });
    ASSERT_EQ(said.size(), 1u) << text;
    const Json line = Json::parse(said[0], nullptr, false);
    ASSERT_TRUE(line.is_object()) << said[0];
    EXPECT_EQ(line["message"], text);
    EXPECT_EQ(line["level"], "info");
    EXPECT_EQ(line["service"], "glove \"left\"");
    EXPECT_EQ(line["rig"], "cell\n1");
    EXPECT_THAT(line["time"].get<std::string>(), testing::ContainsRegex(date));
    EXPECT_FALSE(line.contains("what"));
    EXPECT_TRUE(std::all_of(said[0].begin(), said[0].end(), [](char c) {
      return c >= 0x20 && c < 0x7f;
    })) << "moves no cursor";
  }
}

TEST_F(Log, BytesThatAreNoTextDoNotBreakALine) {
  log::set_format(log::Format::json);
  for (const auto& text : {"\xff\xfe"s, "a\xc3"s, "\xc3("s, "\xed\xa0\x80"s}) {
    const auto said = lines([&] { log::error("{}", text); });
    ASSERT_EQ(said.size(), 1u);
    EXPECT_TRUE(Json::parse(said[0], nullptr, false).is_object()) << said[0];
  }
}

TEST_F(Log, AnErrorKeepsItsParts) {
  const Error error{"is not \"there\"", "/dev/ttyUSB0\n", "plug it in"};
  log::set_format(log::Format::json);
  auto said = lines([&] {
    log::error(error);
    log::warning(Error{"is late", "", ""});
  });
  ASSERT_EQ(said.size(), 2u);
  Json line = Json::parse(said[0]);
  EXPECT_EQ(line["level"], "error");
  EXPECT_EQ(line["message"], error.message());
  EXPECT_EQ(line["what"], error.what);
  EXPECT_EQ(line["where"], error.where);
  EXPECT_EQ(line["hint"], error.hint);
  line = Json::parse(said[1]);
  EXPECT_EQ(line["level"], "warning");
  EXPECT_FALSE(line.contains("where"));
  EXPECT_FALSE(line.contains("rig")) << "no lab was joined";
  EXPECT_EQ(line["service"], "prehend");

  log::set_format(log::Format::text);
  said = lines([&] { log::error(error); });
  ASSERT_EQ(said.size(), 2u) << "the second line is set in";
  EXPECT_THAT(said[0], testing::HasSubstr("error /dev/ttyUSB0"));
}

TEST_F(Log, OnlyWhoAsksHearsMore) {
  for (const auto format : {log::Format::text, log::Format::json}) {
    log::set_format(format);
    log::set_verbose(false);
    EXPECT_TRUE(lines([] { log::debug("detail"); }).empty());
    log::set_verbose(true);
    EXPECT_EQ(lines([] { log::debug("detail"); }).size(), 1u);
  }
}

TEST_F(Log, FormatsHaveNames) {
  EXPECT_EQ(log::format_of("json"), log::Format::json);
  EXPECT_EQ(log::format_of("text"), log::Format::text);
  EXPECT_FALSE(log::format_of("JSON"));
}

}  // namespace
}  // namespace prehend
