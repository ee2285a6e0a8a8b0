// Typed writers and readers over real DDS: values arrive whole, rigs are apart, gone instances are
// told with their key, late joiners get what is transient local, and bad poses are refused.
#include "common/dds/participant.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>

#include "common/convert/convert.hpp"
#include "tests/support/domains/domain_lease.hpp"

namespace prehend::dds {
namespace {

Participant join(int domain, const std::string& rig) {
  auto made = Participant::create({.name = "test", .domain = domain, .rig = rig});
  EXPECT_TRUE(made) << made.error().message();
  return std::move(*made);
}

template <class T>
std::vector<Sample<T>> wait_for(Reader<T>& reader, std::size_t count, int seconds = 5) {
  std::vector<Sample<T>> samples;
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(seconds);
  while (samples.size() < count && std::chrono::steady_clock::now() < give_up) {
    reader.raw().wait_for_unread_message({0, 100'000'000});
    for (auto& sample : reader.take()) samples.push_back(std::move(sample));
  }
  return samples;
}

v1::ObjectDetection detection(std::uint32_t track, const std::string& name) {
  v1::ObjectDetection message;
  message.track(track);
  message.stamp_ns(123);
  message.name(name.c_str());
  message.shape(v1::SHAPE_CYLINDER);
  message.size(convert::to_message(Eigen::Vector3d(0.03, 0.03, 0.1)));
  message.X_WO(convert::to_message(make_pose(Eigen::Vector3d(1, 2, 3))));
  message.covariance()[5] = 0.25;
  return message;
}

TEST(Participant, ALateReaderGetsTheLastDetectionAndItsEnd) {
  const test::DomainLease lease;
  const int domain = lease.domain();
  const std::string rig = "rig" + std::to_string(getpid());
  Participant first = join(domain, rig), second = join(domain, rig);
  auto writer = *first.writer(object_detection);
  ASSERT_TRUE(writer.write(detection(4, "Talc")));
  ASSERT_TRUE(writer.write(detection(7, "Cup")));
  auto reader = *second.reader(object_detection);  // joins after the writing
  const auto samples = wait_for(reader, 2);
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples[1].data.name(), "Cup");
  EXPECT_EQ(samples[1].data.covariance()[5], 0.25);
  EXPECT_NE(samples[0].info.instance, samples[1].info.instance);
  const auto X = convert::from_message(samples[1].data.X_WO());
  ASSERT_TRUE(X);
  EXPECT_EQ(X->translation(), Eigen::Vector3d(1, 2, 3));

  ASSERT_TRUE(writer.dispose(detection(7, "")));
  const auto gone = wait_for(reader, 1);
  ASSERT_EQ(gone.size(), 1u);
  EXPECT_TRUE(gone[0].info.gone);
  EXPECT_EQ(gone[0].data.track(), 7u);
}

TEST(Participant, RigsDoNotHearEachOther) {
  const test::DomainLease lease;
  const int domain = lease.domain();
  const std::string rig = "rig" + std::to_string(getpid());
  Participant here = join(domain, rig + "a"), also_here = join(domain, rig + "a"),
              elsewhere = join(domain, rig + "b");
  auto writer = *here.writer(object_detection);
  auto near = *also_here.reader(object_detection);
  auto far = *elsewhere.reader(object_detection);
  ASSERT_TRUE(writer.write(detection(1, "Cup")));
  ASSERT_EQ(wait_for(near, 1).size(), 1u);
  EXPECT_TRUE(far.take().empty());
}

TEST(Participant, MistakesAreErrors) {
  EXPECT_FALSE(Participant::create({.name = "test", .domain = 300}));
  const test::DomainLease lease;
  Participant here = join(lease.domain(), "x");
  EXPECT_FALSE(here.writer(Topic<v1::GloveFramePubSubType>({.name = "no/such/topic"})));
  v1::Pose bad;  // a default quaternion has no norm
  EXPECT_FALSE(convert::from_message(bad));
}

}  // namespace
}  // namespace prehend::dds
