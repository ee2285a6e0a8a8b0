// What people write as a number is read in one way, and is finite.
#include "common/base/finite_number.hpp"

#include <gtest/gtest.h>

namespace prehend {
namespace {

TEST(FiniteNumber, ListsAreWholeOrNothing) {
  EXPECT_EQ(finite_list("0.1, -2,3e2"), (std::vector<double>{0.1, -2, 300}));
  EXPECT_EQ(finite_list("5"), std::vector<double>{5});
  EXPECT_EQ(finite_list("1;+2", ';'), (std::vector<double>{1, 2}));
  for (const char* text :
       {"", ",", "1,", ",1", "1,,2", "1,nan", "inf,1", "1,1e309", "1,5m", "1 2", "+-1", "0x10"})
    EXPECT_FALSE(finite_list(text)) << text;
}

TEST(FiniteNumber, SaysWhatIsWrong) {
  EXPECT_EQ(no_finite_number("nan"), "nan is no finite number");
  EXPECT_EQ(no_finite_number("1e309"), "1e309 is no finite number");
  EXPECT_EQ(no_finite_number("five"), "five is no number");
  EXPECT_EQ(no_finite_number("5m"), "5m is no number, write it without a unit");
  EXPECT_EQ(no_finite_number(""), "is empty, a number is wanted");
  EXPECT_EQ(no_finite_number("\x1b[2J").find('\x1b'), std::string::npos);
}

}  // namespace
}  // namespace prehend
