// What a button of the page may order, and nothing else.
#include "services/console/core/orders.hpp"

#include <gtest/gtest.h>

namespace prehend::console {
namespace {

TEST(Orders, AreThoseOfThePagesButtons) {
  const auto release = read_order(R"({"action":"release","argument":"nobody is near"})");
  ASSERT_TRUE(release);
  EXPECT_EQ(release->kind, OrderKind::release);
  EXPECT_EQ(release->target, "gate");
  EXPECT_EQ(release->argument, "nobody is near");
  EXPECT_TRUE(read_order(R"({"action":"stop"})"));
  const auto replay = read_order(R"({"action":"replay","argument":"rate 0.5"})");
  ASSERT_TRUE(replay);
  EXPECT_EQ(replay->target, "replayer");
  EXPECT_FALSE(read_order(R"({"action":"release"})")) << "it must say why";
  EXPECT_FALSE(read_order(R"({"action":"move","argument":"hand"})"));
  EXPECT_FALSE(read_order(R"({"action":"stop","argument":"a\nb"})"));
  EXPECT_FALSE(read_order("[]"));
  EXPECT_FALSE(read_order(R"({"action":"stop","argument":")" + std::string(200, 'a') + "\"}"));
}

TEST(Orders, AnObjectIsPlacedSomewhereOnTheTable) {
  const auto place = read_order(R"({"action":"place","argument":"Talc","x":0.1,"y":-0.2})");
  ASSERT_TRUE(place) << place.error().message();
  EXPECT_EQ(place->kind, OrderKind::place);
  EXPECT_EQ(place->target, "simulation");
  EXPECT_EQ(place->x, 0.1);
  EXPECT_EQ(place->y, -0.2);
  for (const char* body : {R"({"action":"place","argument":"Talc"})",
                           R"({"action":"place","argument":"Talc","x":0.1})",
                           R"({"action":"place","argument":"Talc","x":"0","y":"0"})",
                           R"({"action":"place","argument":"Talc","x":9,"y":0})",
                           R"({"action":"place","argument":"Talc","x":1e999,"y":0})",
                           R"({"action":"place","x":0,"y":0})"})
    EXPECT_FALSE(read_order(body)) << body;
}

}  // namespace
}  // namespace prehend::console
