#include "common/model/grasp_taxonomy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "common/base/file_text.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::model {
namespace {

const std::string& text() {
  static const std::string read =
      *read_file(test::in_sources("common/models/grasps/taxonomy.toml"));
  return read;
}

const GraspTaxonomy& taxonomy() {
  static const auto made = GraspTaxonomy::parse(text());
  return *made;
}

std::set<std::string> names_with(const std::vector<double>& fit, double least) {
  std::set<std::string> made;
  for (std::size_t i = 0; i < fit.size(); ++i)
    if (fit[i] >= least) made.insert(taxonomy().classes()[i].name);
  return made;
}

TEST(GraspTaxonomy, HasCutkoskysSixteenEachOnceAmongFeixs) {
  const auto made = GraspTaxonomy::parse(text());
  ASSERT_TRUE(made) << made.error().message();
  ASSERT_EQ(made->classes().size(), 16U);
  std::set<int> numbers;
  int power = 0, circular = 0;
  for (const GraspClass& one : made->classes()) {
    numbers.insert(one.feix);
    power += one.kind == GraspKind::power;
    circular += one.form == GraspForm::circular;
  }
  EXPECT_EQ(numbers, (std::set<int>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16}));
  EXPECT_EQ(power, 9);
  EXPECT_EQ(circular, 5);  // disks, spheres, tripod
}

// Figure 3.6 of the thesis: a cup may be taken by a sphere from above, a wrap or a precision grasp;
// who wants to fill it does not take it by its opening.
TEST(GraspTaxonomy, ACupThatIsToBeFilledIsNotTakenByItsOpening) {
  const Shape cup{ShapeKind::cylinder, {0.033, 0.033, 0.093}};
  const auto of_cup = names_with(taxonomy().fit_to_object(cup), 0.6);
  EXPECT_TRUE(of_cup.contains("power sphere"));
  EXPECT_TRUE(of_cup.contains("large diameter"));
  EXPECT_TRUE(of_cup.contains("tripod"));
  EXPECT_FALSE(of_cup.contains("lateral pinch"));
  EXPECT_FALSE(of_cup.contains("light tool"));
  const auto of_task = names_with(taxonomy().fit_to_task({ObjectPart::opening}), 1);
  EXPECT_FALSE(of_task.contains("power sphere"));
  EXPECT_TRUE(of_task.contains("large diameter"));
  EXPECT_TRUE(of_task.contains("tripod"));
  EXPECT_EQ(names_with(taxonomy().fit_to_task({}), 1).size(), 16U);
}

TEST(GraspTaxonomy, WidthOutsideTheRangeMakesAClassLessLikely) {
  const auto fit = [](double radius) {
    const auto all = taxonomy().fit_to_object({ShapeKind::cylinder, {radius, radius, 0.1}});
    return all[0];  // large diameter, 55 to 130 mm
  };
  EXPECT_EQ(fit(0.04), 1);
  EXPECT_NEAR(fit(0.055 / 4), 0.135, 0.001) << "an octave below";
  EXPECT_LT(fit(0.01), fit(0.02));
  for (const double x : taxonomy().fit_to_object({})) EXPECT_EQ(x, 1) << "of an unknown shape";
}

TEST(GraspTaxonomy, EveryHandHasATypeForEveryClass) {
  for (const GraspClass& one : taxonomy().classes()) {
    EXPECT_EQ(taxonomy().robot_type(one, "barrett"), one.robot);
    EXPECT_NE(taxonomy().robot_type(one, "parallel_jaw"), "circular sphere");
  }
}

std::string with(const std::string& from, const std::string& to) {
  std::string made = text();
  made.replace(made.find(from), from.size(), to);
  return made;
}

TEST(GraspTaxonomy, SaysWhatIsWrongAndInWhichClass) {
  for (const auto& [from, to, what] :
       {std::tuple("kind = \"power\"", "kind = \"strong\"", "kind is none of power or precision"),
        std::tuple("feix = 1\n", "feix = 34\n", "feix"),
        std::tuple("width = [0.055, 0.13]", "width = [0.13, 0.055]", "width"),
        std::tuple("\"index\", \"middle\"", "\"index\", \"index\"", "opposed"),
        std::tuple("shapes = [\"cylinder\", \"box\"]", "shapes = [\"unknown\"]",
                   "shapes has what is none of cylinder, box, sphere or cone, or twice"),
        std::tuple("shapes = [\"cylinder\", \"box\"]", "shapes = \"box\"",
                   "shapes is no list of cylinder, box, sphere or cone"),
        std::tuple("shapes = [\"cylinder\", \"box\"]", "shapes = []",
                   "opposed and shapes may not be empty"),
        std::tuple("blocks = []", "blocks = \"all\"", "blocks"),
        std::tuple("robot = \"power wrap\"", "robot = \"wrap\"", "robot")}) {
    const auto made = GraspTaxonomy::parse(with(from, to));
    ASSERT_FALSE(made) << to;
    EXPECT_NE(made.error().what.find(what), std::string::npos) << made.error().message();
    EXPECT_EQ(made.error().where, "class 1");
  }
  EXPECT_FALSE(GraspTaxonomy::parse(with("width = [0.055, 0.13]", "width = [nan, 0.055]")));
  EXPECT_FALSE(GraspTaxonomy::parse("class = 3"));
  EXPECT_FALSE(GraspTaxonomy::parse("[[class"));
  EXPECT_FALSE(GraspTaxonomy::parse(text() + "\n[robot.x]\n\"wrap\" = \"precision\"\n"));
  for (const auto& [toml, told] :
       {std::pair(std::string("class = [3]"), "class 1: is no table (write [[class]])"),
        std::pair(text() + "\n[robot]\nx = 3\n", "robot.x: is no table (write [robot.x])")}) {
    const auto made = GraspTaxonomy::parse(toml);
    ASSERT_FALSE(made) << told;
    EXPECT_EQ(made.error().message(), told);
  }
  const auto twice =
      GraspTaxonomy::parse(with("name = \"small diameter\"", "name = \"large diameter\""));
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().where, "class 2");
}

}  // namespace
}  // namespace prehend::model
