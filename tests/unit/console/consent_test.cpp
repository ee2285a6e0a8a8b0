// A button that lets a hand move while it is held: what is said late gives no consent.
#include "services/console/core/consent.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace prehend::console {
namespace {

using nlohmann::json;

constexpr std::int64_t ms = 1'000'000, moment = 1'700'000'000'123 * ms;

json held(std::int64_t since_ms) {
  const std::int64_t told = json::parse(consent_answer(moment))["now_ms"].get<std::int64_t>();
  return {{"hand", "hand"}, {"held", true}, {"now_ms", told - since_ms}};
}

TEST(Consent, IsGivenByAWordThatFollowsOurLastAnswer) {
  for (const int since : {0, 30, 200}) {
    const auto consent = read_consent(held(since).dump(), moment);
    ASSERT_TRUE(consent) << consent.error().message();
    EXPECT_TRUE(consent->held);
    EXPECT_EQ(consent->hand, "hand");
  }
}

TEST(Consent, IsNotGivenByWhatWasLongOnItsWay) {
  for (const std::int64_t since : {std::int64_t{201}, std::int64_t{5000}, std::int64_t{-1},
                                   std::numeric_limits<std::int64_t>::min() / 2})
    EXPECT_FALSE(read_consent(held(since).dump(), moment)) << since;
  json timeless = held(0);
  timeless.erase("now_ms");
  EXPECT_FALSE(read_consent(timeless.dump(), moment));
  timeless["now_ms"] = "now";
  EXPECT_FALSE(read_consent(timeless.dump(), moment));
  timeless["now_ms"] = std::numeric_limits<std::uint64_t>::max();
  EXPECT_FALSE(read_consent(timeless.dump(), moment));
}

TEST(Consent, EndsWhenever) {
  const auto consent = read_consent(R"({"hand":"hand","held":false})", moment);
  ASSERT_TRUE(consent);
  EXPECT_FALSE(consent->held);
}

TEST(Consent, IsForAHandThatIsNamed) {
  for (const json& hand : {json(), json(""), json(7), json(std::string(64, 'x')), json("a\nb")}) {
    json said = held(0);
    said["hand"] = hand;
    EXPECT_FALSE(read_consent(said.dump(), moment)) << said;
  }
  for (const char* body : {"", "[]", "{}", R"({"hand":"hand"})", R"({"hand":"hand","held":1})"})
    EXPECT_FALSE(read_consent(body, moment)) << body;
}

}  // namespace
}  // namespace prehend::console
