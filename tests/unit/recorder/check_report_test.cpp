// What a check says of its findings: one verdict, whoever reads it.
#include "services/recorder/tools/check/check_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace prehend::recorder {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Checked of_two_topics(std::uint64_t different) {
  Checked checked;
  checked.report.topics = {{.name = "hand/posture", .compared = 9},
                           {.name = "robot/command", .compared = 8, .different = different}};
  if (different > 0)
    checked.report.topics[1].first.push_back(
        {.sample = "hand «a» & <b>", .field = "weight", .expected = "0", .actual = "1"});
  checked.services = {"glove", "mapping"};
  return checked;
}

TEST(CheckReport, IsTheSameWhereNothingDiffers) {
  const Checked checked = of_two_topics(0);
  const auto document = nlohmann::json::parse(to_json(checked.report));
  EXPECT_EQ(document["verdict"], "same");
  EXPECT_FALSE(document["topics"][1].contains("first_difference"));
  EXPECT_THAT(to_text(checked), HasSubstr("same: glove, mapping"));
  EXPECT_THAT(to_junit("a.mcap", checked), HasSubstr("failures=\"0\""));
}

TEST(CheckReport, NamesTheFirstDifference) {
  const Checked checked = of_two_topics(2);
  const auto document = nlohmann::json::parse(to_json(checked.report));
  EXPECT_EQ(document["verdict"], "different");
  EXPECT_EQ(document["topics"][1]["different"], 2);
  EXPECT_THAT(document["topics"][1]["first_difference"].get<std::string>(), HasSubstr("weight"));
  EXPECT_THAT(to_text(checked), HasSubstr("different: glove, mapping"));
}

TEST(CheckReport, IsXmlWhateverNamesSay) {
  Checked checked = of_two_topics(2);
  const std::string xml = to_junit("<a> & \"b\"\n", checked);
  EXPECT_THAT(xml, HasSubstr("name=\"&lt;a&gt; &amp; &quot;b&quot; \""));
  EXPECT_THAT(xml, HasSubstr("failures=\"1\""));
  EXPECT_THAT(xml, Not(HasSubstr("& <b>")));
}

}  // namespace
}  // namespace prehend::recorder
