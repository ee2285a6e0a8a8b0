// The tables that services print are read entry by entry; whatever is no such table is refused, and
// a name that is in none of its rows is answered with those that are.
#include "services/cli/tools/demo/rows.hpp"

#include <gtest/gtest.h>

namespace prehend::cli {
namespace {

constexpr const char* gloves =
    R"({"devices":[{"name":"a","line":"serial","emulator":true,"tracker":"b","more":[1]},
                   {"name":"b","line":"file","emulator":false,"tracker":null}]})";

TEST(Rows, OfGlovesAreRead) {
  const auto rows = glove_rows(gloves);
  ASSERT_TRUE(rows) << rows.error().message();
  ASSERT_EQ(rows->size(), 2u);
  EXPECT_EQ(rows->at(0).name, "a");
  EXPECT_EQ(rows->at(0).line, "serial");
  EXPECT_TRUE(rows->at(0).emulator);
  EXPECT_EQ(rows->at(0).tracker, "b");
  EXPECT_FALSE(rows->at(1).emulator);
  EXPECT_EQ(rows->at(1).tracker, "");
}

TEST(Rows, OfCamerasAreRead) {
  const auto rows = camera_rows(
      R"({"sources":[{"name":"drawn","from_scene":true},{"name":"real","from_scene":false}]})");
  ASSERT_TRUE(rows) << rows.error().message();
  ASSERT_EQ(rows->size(), 2u);
  EXPECT_TRUE(rows->at(0).synthetic);
  EXPECT_FALSE(rows->at(1).synthetic);
}

TEST(Rows, AreRefusedWhenTheyAreNoTable) {
  for (const char* wrong :
       {"", "[]", "{}", R"({"devices":[]})", R"({"devices":[{}]})", R"({"devices":[{"name":1}]})",
        R"({"devices":[{"name":"a","line":"serial","emulator":"yes","tracker":null}]})",
        R"({"devices":7})"}) {
    EXPECT_FALSE(glove_rows(wrong)) << wrong;
    EXPECT_FALSE(camera_rows(wrong)) << wrong;
  }
}

TEST(Rows, AreFoundByName) {
  const auto rows = glove_rows(gloves).value();
  EXPECT_EQ(find_row(rows, "b", "--glove")->line, "file");
  const auto none = find_row(rows, "c", "--glove");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().message(), "--glove: there is no 'c' (choose one of a, b)");
  const auto nothing = glove_row({rows.back()}, "");
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().message(),
            "--glove: no device can be emulated (name one, and plug it in)");
}

}  // namespace
}  // namespace prehend::cli
