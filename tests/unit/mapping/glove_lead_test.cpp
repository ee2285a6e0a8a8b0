// One glove leads; another one waits until it has been silent.
#include "services/mapping/core/glove_lead.hpp"

#include <gtest/gtest.h>

namespace prehend::mapping {
namespace {

constexpr GloveLead::Writer alice{1}, bob{2};
Time after(double s) {
  return Time(std::chrono::hours(1)) + seconds(s);
}

TEST(GloveLead, TheFirstThatIsAnsweredLeadsUntilItIsSilent) {
  GloveLead lead;
  EXPECT_TRUE(lead.admits(alice, after(0)));
  EXPECT_TRUE(lead.admits(bob, after(0))) << "nothing of alice could be answered";
  lead.followed(alice, after(0));
  EXPECT_FALSE(lead.second(after(0)));
  EXPECT_FALSE(lead.admits(bob, after(0.29)));
  lead.refused(bob, after(0.29));
  EXPECT_EQ(lead.second(after(1)), bob);
  EXPECT_FALSE(lead.second(after(1.5))) << "it has given up";
  EXPECT_TRUE(lead.admits(alice, after(0.29)));
  EXPECT_TRUE(lead.admits(bob, after(0.31)));
  lead.followed(bob, after(0.31));
  EXPECT_FALSE(lead.second(after(0.31)));
  EXPECT_FALSE(lead.admits(alice, after(0.4)));
}

}  // namespace
}  // namespace prehend::mapping
