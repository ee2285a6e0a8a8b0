// What an operator may say to a running mapping: every mode by its own words comes back, and what
// is not understood changes nothing.
#include "services/mapping/core/mapping_modes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace prehend::mapping {
namespace {

TEST(MappingModesTest, ComeBackFromTheirOwnWords) {
  for (const FingerMode fingers :
       {FingerMode::joints, FingerMode::cartesian, FingerMode::combined, FingerMode::retargeting})
    for (const bool intelligent : {false, true})
      for (const bool placement : {false, true}) {
        const MappingModes modes{fingers, intelligent, placement};
        const auto back = changed({}, to_string(modes));
        ASSERT_TRUE(back) << back.error().message();
        EXPECT_EQ(*back, modes);
      }
}

TEST(MappingModesTest, WhatIsNotNamedStays) {
  const MappingModes before{FingerMode::combined, false, false};
  EXPECT_EQ(changed(before, "intelligent"), (MappingModes{FingerMode::combined, true, false}));
  EXPECT_EQ(changed(before, "  joints  placement "),
            (MappingModes{FingerMode::joints, false, true}));
  EXPECT_EQ(changed(before, "direct direct"), before);
}

TEST(MappingModesTest, RefusesWhatIsNotUnderstood) {
  using testing::HasSubstr;
  const auto refusal = [](std::string_view order) {
    const auto made = changed({}, order);
    return made ? "understood" : made.error().message();
  };
  EXPECT_THAT(refusal(""), HasSubstr("no mode is named"));
  EXPECT_THAT(refusal(" \t\n"), HasSubstr("no mode is named"));
  EXPECT_THAT(refusal("joints please"), HasSubstr("there is no mode «please»"));
  EXPECT_THAT(refusal("joints cartesian"), HasSubstr("«cartesian» contradicts"));
  EXPECT_THAT(refusal("intelligent direct"), HasSubstr("«direct» contradicts"));
  EXPECT_THAT(refusal("placement no-placement"), HasSubstr("«no-placement» contradicts"));
}

}  // namespace
}  // namespace prehend::mapping
