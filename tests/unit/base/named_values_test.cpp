// A table of names is read in both directions and told in a message; what is not in it is said so.
#include "common/base/named_values.hpp"

#include <gtest/gtest.h>

namespace prehend {
namespace {

enum class Colour { red, green, blue, infrared };
constexpr auto colours = named_values<Colour>(
    {{Colour::red, "red"}, {Colour::green, "green", "of grass"}, {Colour::blue, "blue"}});

TEST(NamedValues, AreReadAndWritten) {
  static_assert(colours.size() == 3);
  static_assert(colours.value("blue") == Colour::blue, "at compile time, too");
  for (const auto& row : colours) {
    EXPECT_EQ(colours.name(row.value), row.name);
    EXPECT_EQ(colours.value(row.name), row.value);
  }
  EXPECT_EQ(colours.rows[1].help, "of grass");
  EXPECT_TRUE(colours.rows[0].help.empty());
}

TEST(NamedValues, SayWhatIsNotThere) {
  EXPECT_EQ(colours.name(Colour::infrared), "unknown");
  EXPECT_EQ(colours.name(Colour::infrared, "?"), "?");
  EXPECT_EQ(colours.value("infrared"), std::nullopt);
  EXPECT_EQ(colours.value(""), std::nullopt);
  EXPECT_EQ(colours.value("Red"), std::nullopt);
}

TEST(NamedValues, AreListedInTheirOrder) {
  EXPECT_EQ(colours.list(), "red, green or blue");
  EXPECT_EQ(colours.list(" and "), "red, green and blue");
  constexpr auto one = named_values<Colour>({{Colour::red, "red"}});
  EXPECT_EQ(one.list(), "red");
}

}  // namespace
}  // namespace prehend
