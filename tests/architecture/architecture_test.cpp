// The rules of the house hold in this tree. That they can be broken, and then say so, is shown for
// each in a house of a few tiny files: it keeps all rules, and each case breaks one of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <memory>
#include <ostream>
#include <set>

#include "tests/architecture/decisions.hpp"
#include "tests/architecture/drawing.hpp"
#include "tests/architecture/rules.hpp"
#include "tests/architecture/small_house.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::architecture {

void PrintTo(const Break& a_break, std::ostream* out);  // for GoogleTest
void PrintTo(const Break& a_break, std::ostream* out) {
  *out << a_break.rule << ": " << a_break.what;
}

namespace {

std::string all_violations(const House& house, const Agreed& agreed) {
  std::string text;
  for (const Rule& rule : rules())
    for (const std::string& violation : violations(rule, house, agreed)) text += violation + "\n";
  return text;
}

TEST(Architecture, RulesHoldInThisTree) {
  const House house = read_house(prehend::test::in_sources(""));
  ASSERT_GT(house.sources.size(), 100u);  // something was read
  ASSERT_GT(house.pages.size(), 10u);
  EXPECT_EQ(all_violations(house, agreed_here), "");
}

TEST(Architecture, TheDrawingIsOfThisTree) {
  std::ifstream in(std::filesystem::path(test::in_sources("ARCHITECTURE.md")));
  const std::string page{std::istreambuf_iterator<char>(in), {}};
  ASSERT_THAT(page, testing::HasSubstr(drawing_begins));
  EXPECT_EQ(with_drawing(page, drawing(read_house(prehend::test::in_sources("")))), page)
      << "draw_architecture --write draws it anew";
}

TEST(Architecture, TheIndexOfDecisionsIsOfThisTree) {
  std::ifstream in(std::filesystem::path(test::in_sources(decisions_page)));
  const std::string page{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ(decisions(read_house(test::in_sources(""))), page)
      << "draw_architecture --write makes it anew";
}

TEST(Architecture, TheIndexOfDecisionsSaysWhatHolds) {
  House house;
  const auto add = [&](const std::string& name, std::vector<std::string> lines) {
    house.pages.push_back({"docs/decisions/" + name, std::move(lines), {}, {}});
  };
  add("0001-one.md", {"# 0001: It stands", "", "**Decision.** So."});
  add("0002-two.md", {"# 0002 It fell", "", "**Overtaken:** by", "0001.", "", "more"});
  add("0003-three.md", {"# 0003: It leans", "**Changed:** since 2026."});
  add("0050-four.md", {"# 0050: 60 steps"});
  add("README.md", {"# Decisions"});
  const std::string page = decisions(house);
  EXPECT_THAT(page, testing::HasSubstr("| [0001](0001-one.md) It stands | yes |\n"));
  EXPECT_THAT(page, testing::HasSubstr("| [0002](0002-two.md) It fell | **no**: by 0001. |\n"));
  EXPECT_THAT(page,
              testing::HasSubstr("| [0003](0003-three.md) It leans | in part: since 2026. |\n"));
  EXPECT_THAT(page, testing::HasSubstr("## Recognition and DDS\n| decision | holds |\n|---|---|\n"
                                       "| [0050](0050-four.md) 60 steps | yes |\n"));
  EXPECT_THAT(page, testing::Not(testing::HasSubstr("README")));
}

TEST(Architecture, ADrawingSaysWhatIncludesWhat) {
  const Tree tree(small_house());
  const std::string drawn = drawing(read_house(tree.root()));
  EXPECT_THAT(drawn, testing::HasSubstr("common_model --> common_base"));
  EXPECT_THAT(drawn, testing::HasSubstr("services_arm_service --> services_arm_core"));
  EXPECT_THAT(drawn, testing::HasSubstr("core<br/>model"));
  // Through the model, that is.
  EXPECT_THAT(drawn, testing::Not(testing::HasSubstr("services_arm_tools --> common_base")));
}

TEST(Architecture, TheSmallHouseKeepsAllRules) {
  const Tree tree(small_house());
  EXPECT_EQ(all_violations(read_house(tree.root()), agreed_in_the_small_house()), "");
}

TEST(Architecture, EveryRuleIsBrokenOnPurpose) {
  std::set<std::string> broken;
  for (const Break& a_break : breaks()) broken.insert(a_break.rule);
  for (const Rule& rule : rules())
    EXPECT_TRUE(broken.contains(std::string(rule.name))) << "no case breaks " << rule.name;
}

// One tree for all cases: writing each anew would take most of the time.
class Broken : public testing::TestWithParam<Break> {
 protected:
  static void SetUpTestSuite() { tree_ = std::make_unique<Tree>(small_house()); }
  static void TearDownTestSuite() { tree_.reset(); }
  void SetUp() override { tree_->change(GetParam().changes); }
  void TearDown() override {
    tree_->undo(GetParam().changes);
    EXPECT_EQ(all_violations(read_house(tree_->root()), agreed_in_the_small_house()), "");
  }
  static inline std::unique_ptr<Tree> tree_;
};

TEST_P(Broken, IsNamedByItsRuleAlone) {
  const House house = read_house(tree_->root());
  for (const Rule& rule : rules()) {
    const auto found = violations(rule, house, agreed_in_the_small_house());
    if (rule.name == GetParam().rule) {
      EXPECT_THAT(found, testing::Contains(testing::StartsWith(GetParam().named + ":")))
          << rule.name;
    } else {
      EXPECT_THAT(found, testing::IsEmpty()) << rule.name;
    }
  }
}

std::string name_of(const testing::TestParamInfo<Break>& info) {
  std::string name = info.param.rule + "_" + info.param.what;
  std::erase_if(name, [](char c) { return c != ' ' && c != '_' && !std::isalnum(c); });
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Rules, Broken, testing::ValuesIn(breaks()), name_of);

}  // namespace
}  // namespace prehend::architecture
