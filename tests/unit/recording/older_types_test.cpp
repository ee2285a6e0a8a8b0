// Recordings of the version before: a message whose type has got a sequence at its end is read with
// an empty one.
#include "common/recording/layout/older_types.hpp"

#include <gtest/gtest.h>

#include "common/dds/raw.hpp"
#include "common/dds/topics.hpp"

namespace prehend::recording {
namespace {

TEST(OlderTypes, HaveTheNamesOfToday) {
  EXPECT_EQ(current_type("prehend::v1::GraspCandidates"), dds::grasp_candidates.type_name());
  EXPECT_EQ(current_type("prehend::v1::HandCommand"), dds::robot_command.type_name());
  EXPECT_EQ(current_type("prehend::v1::GloveFrame"), "prehend::v1::GloveFrame");
}

TEST(OlderTypes, CandidatesAreReadAndSayNothingOfFollowThrough) {
  v1::GraspCandidate candidate;
  candidate.dof({0.1, 0.2, 0.3});
  candidate.room(0.75);
  v2::GraspCandidates message;
  message.track(7);
  message.object("Cup");
  message.candidates({candidate, candidate});
  dds::RawSample sample;
  sample.payload = dds::encode(dds::grasp_candidates, message);
  // As the version before wrote it: without the count of the empty sequence.
  ASSERT_GT(sample.payload.size(), 4u);
  sample.payload.resize(sample.payload.size() - 4);
  v2::GraspCandidates read;
  EXPECT_FALSE(dds::decode(dds::grasp_candidates, sample, read));
  make_current(sample.payload);
  read = {};
  ASSERT_TRUE(dds::decode(dds::grasp_candidates, sample, read));
  EXPECT_EQ(read, message);
}

}  // namespace
}  // namespace prehend::recording
