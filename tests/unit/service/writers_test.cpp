// Of several who write, one is chosen by its name.
#include "common/service/writers.hpp"

#include <gtest/gtest.h>

namespace prehend::service {
namespace {

const dds::GuidPrefix alice{1}, bob{2}, player{3};

Time after(double s) {
  return Time(std::chrono::hours(1)) + seconds(s);
}

std::string name_of(const dds::GuidPrefix& writer) {
  return writer == alice ? "glove@here/1" : writer == bob ? "glove@there/2" : "replayer@here/3";
}

class WritersTest : public testing::Test {
 protected:
  WritersTest() {
    for (const auto& writer : {alice, bob, player}) writers_.heard(writer, after(0));
  }
  Expected<dds::GuidPrefix> named(const std::string& name, double s = 0.5) const {
    return writers_.named(name, alice, after(s), name_of, "hand/posture");
  }
  Writers writers_;
};

TEST_F(WritersTest, AreChosenByTheirNames) {
  EXPECT_EQ(named("glove@here/1"), alice);
  EXPECT_EQ(named("glove@there/2"), bob);
  EXPECT_EQ(named("glove"), bob) << "the one that does not lead";
  EXPECT_EQ(named("replayer"), player);
}

TEST_F(WritersTest, OtherNamesAreErrorsThatNameThem) {
  const auto nobody = named("mapping");
  ASSERT_FALSE(nobody);
  EXPECT_EQ(nobody.error().what, "does not send hand/posture");
  EXPECT_NE(nobody.error().hint.find("glove@here/1, glove@there/2, replayer@here/3"),
            std::string::npos);
  EXPECT_FALSE(named(""));
  writers_.heard({4}, after(0));
  EXPECT_EQ(named("replayer").error().what, "several are called so");
}

TEST_F(WritersTest, WhoIsSilentIsGoneAndACrowdTakesNoMemory) {
  EXPECT_FALSE(named("replayer", 1.5));
  for (std::uint8_t i = 10; i < 100; ++i) writers_.heard({i}, after(0.1));
  EXPECT_TRUE(named("glove", 0.9));
  writers_.heard(bob, after(2));
  EXPECT_EQ(named("glove", 2.1), bob);
}

}  // namespace
}  // namespace prehend::service
