#include "common/model/task_kinds.hpp"

#include <gtest/gtest.h>

#include <set>

#include "common/base/file_text.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::model {
namespace {

const std::string& tasks_text() {
  static const std::string read = *read_file(test::in_sources("common/models/tasks/tasks.toml"));
  return read;
}

const TaskKinds& tasks() {
  static const auto made = TaskKinds::parse(tasks_text());
  return *made;
}

const GraspTaxonomy& grasps() {
  static const auto made =
      GraspTaxonomy::load(test::in_sources("common/models/grasps/taxonomy.toml"));
  return *made;
}

/// Types of grasps of robot hands that are left for an object in a task, and whether some kind of
/// each comes from the side.
std::set<std::pair<std::string, bool>> left(const Shape& shape, std::string_view task) {
  const auto of_object = grasps().fit_to_object(shape);
  const auto of_task = grasps().fit_to_task(tasks().keep_free(task));
  std::set<std::pair<std::string, bool>> made;
  for (std::size_t i = 0; i < of_object.size(); ++i) {
    const GraspClass& kind = grasps().classes()[i];
    if (of_object[i] * of_task[i] > 0.9) made.emplace(kind.robot, kind.approach == Approach::side);
  }
  return made;
}

// Figure 3.6 of the thesis: by its shape a cup is taken by a circular sphere, a power wrap or a
// precision grasp; who fills it with coffee is left the two that do not block its opening, which
// are those from the side.
TEST(TaskKinds, ACupThatIsFilledIsWrappedOrTakenWithFingertipsFromTheSide) {
  const Shape cup{ShapeKind::cylinder, {0.033, 0.033, 0.093}};
  const std::pair sphere("circular sphere", false), wrap("power wrap", true),
      precision("precision", true);
  using Types = std::set<std::pair<std::string, bool>>;
  EXPECT_EQ(left(cup, "move"), (Types{sphere, wrap, precision}));
  for (const char* task : {"fill", "Fill_cup", "pour coffee", "drink"})
    EXPECT_EQ(left(cup, task), (Types{wrap, precision})) << task;
}

TEST(TaskKinds, ATaskIsOfTheKindThatItsNameHasAsWords) {
  ASSERT_TRUE(TaskKinds::parse(tasks_text())) << TaskKinds::parse(tasks_text()).error().message();
  for (const auto& [task, kind] :
       {std::pair("pour", "pour"), std::pair("Pour-tea.2", "pour"), std::pair("POUR TEA", "pour"),
        std::pair("now hand  over", "hand over"), std::pair("cut bread", "cut")}) {
    ASSERT_TRUE(tasks().of_task(task)) << task;
    EXPECT_EQ(tasks().of_task(task)->name, kind);
  }
  for (const char* task : {"", "TEA", "downpour", "haircut", "hand", "over hand", "pouring"})
    EXPECT_FALSE(tasks().of_task(task)) << task;
  EXPECT_TRUE(tasks().keep_free("TEA").empty());
  EXPECT_EQ(tasks().keep_free("cut"), std::vector{ObjectPart::blade});
}

TEST(TaskKinds, SaysWhatIsWrongAndWhere) {
  const auto said = [](const std::string& toml) {
    const auto made = TaskKinds::parse(toml);
    return made ? "read" : made.error().message();
  };
  EXPECT_NE(said("[[task").find("TOML"), std::string::npos);
  EXPECT_NE(said("task = 3").find("has no [[task]]"), std::string::npos);
  EXPECT_EQ(said("task = [3]"), "task 1: is no table (write [[task]])");
  EXPECT_NE(said("[[task]]\nname = \"Pour\"\nkeep_free = []").find("task 1"), std::string::npos);
  EXPECT_NE(said("[[task]]\nname = \"pour\"").find("keep_free is no list"), std::string::npos);
  EXPECT_NE(said("[[task]]\nname = \"pour\"\nkeep_free = [\"lid\"]").find("none of"),
            std::string::npos);
  EXPECT_NE(
      said(tasks_text() + "\n[[task]]\nname = \"cut\"\nkeep_free = []").find("two kinds named cut"),
      std::string::npos);
}

}  // namespace
}  // namespace prehend::model
