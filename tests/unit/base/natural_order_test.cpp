// Names in the order in which a person counts.
#include "common/base/natural_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/base/random.hpp"

namespace prehend {
namespace {

TEST(NaturalOrder, NumbersInNamesCount) {
  std::vector<std::string> names{"shot10.jpg", "shot2.jpg", "shot1.jpg",
                                 "a",          "shot9b",    "99999999999999999999999",
                                 "Shot3",      "shot",      "100000000000000000000000"};
  std::sort(names.begin(), names.end(), natural_less);
  EXPECT_EQ(names, (std::vector<std::string>{"99999999999999999999999", "100000000000000000000000",
                                             "Shot3", "a", "shot", "shot1.jpg", "shot2.jpg",
                                             "shot9b", "shot10.jpg"}));
  EXPECT_TRUE(natural_less("a1b2", "a01b10"));
  EXPECT_TRUE(natural_less("a1", "a01"));  // and never both
  EXPECT_FALSE(natural_less("a01", "a1"));
  EXPECT_FALSE(natural_less("a", "a"));
  EXPECT_TRUE(natural_less("", "0"));
}

// Sorting is undefined with anything less than a strict order.
TEST(NaturalOrder, IsAStrictOrderOverAnyNames) {
  Random random(1);
  std::vector<std::string> names;
  for (int i = 0; i < 60; ++i) {
    std::string name;
    for (std::size_t n = random.index(6); n > 0; --n) name += "0012ab\xc3."[random.index(8)];
    names.push_back(name);
  }
  for (const auto& a : names)
    for (const auto& b : names) {
      EXPECT_EQ(int(natural_less(a, b)) + int(natural_less(b, a)), a == b ? 0 : 1) << a << ' ' << b;
      for (const auto& c : names) {
        if (!natural_less(a, b) || !natural_less(b, c)) continue;
        EXPECT_TRUE(natural_less(a, c)) << a << ' ' << b << ' ' << c;
      }
    }
}

}  // namespace
}  // namespace prehend
