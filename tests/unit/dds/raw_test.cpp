// Raw topics over real DDS: what a typed writer says is found by discovery, read as bytes, written
// again by a raw writer and read by a typed reader, and nothing has changed on the way: bytes,
// keys, ends of instances, source time stamps, QoS.
#include "common/dds/raw.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <map>
#include <thread>

#include "tests/support/domains/domain_lease.hpp"

namespace prehend::dds {
namespace {

using Kind = RawSample::Kind;

/// Collects what other threads say.
template <class T>
class Collector {
 public:
  void add(T value) {
    const std::scoped_lock lock(mutex_);
    values_.push_back(std::move(value));
    news_.notify_all();
  }
  /// All so far, as soon as `enough` of them say so or after 5 s.
  std::vector<T> wait(const std::function<bool(const std::vector<T>&)>& enough) {
    std::unique_lock lock(mutex_);
    news_.wait_for(lock, std::chrono::seconds(5), [&] { return enough(values_); });
    return values_;
  }
  std::vector<T> wait(std::size_t count) {
    return wait([count](const auto& values) { return values.size() >= count; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable news_;
  std::vector<T> values_;
};

struct Raw : testing::Test {
  const test::DomainLease lease;
  const int domain = lease.domain();
  std::string rig = "raw-" + std::to_string(getpid());

  Participant join(const std::string& where, DiscoveryEvents* listener = nullptr) {
    auto made = Participant::create(
        {.name = "test", .domain = domain, .rig = rig + where, .listener = listener});
    EXPECT_TRUE(made) << made.error().message();
    return std::move(*made);
  }
  static void meet(eprosima::fastdds::dds::DataWriter& writer) {
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    eprosima::fastdds::dds::PublicationMatchedStatus status;
    while (status.current_count == 0 && std::chrono::steady_clock::now() < give_up)
      writer.get_publication_matched_status(status);
    ASSERT_GT(status.current_count, 0);
  }
  /// The reader may know the writer later than the other way round. What is written meanwhile it
  /// gets only as far as the writer keeps it: of this topic one sample an instance.
  static bool met(const RawReader& reader) {
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    while (reader.writers() == 0 && std::chrono::steady_clock::now() < give_up)
      std::this_thread::yield();
    return reader.writers() > 0;
  }
  static bool match(DiscoveredWriter& out, Collector<DiscoveredWriter>& found,
                    const std::string& topic) {
    const auto there = [&](const DiscoveredWriter& one) {
      return one.topic.name == topic && !one.gone;
    };
    const auto all =
        found.wait([&](const auto& list) { return std::any_of(list.begin(), list.end(), there); });
    const auto one = std::find_if(all.begin(), all.end(), there);
    if (one == all.end()) return false;
    out = *one;
    return true;
  }
};

v1::ObjectDetection raw_detection(std::uint32_t track, const std::string& name) {
  v1::ObjectDetection message;
  message.track(track);
  message.stamp_ns(123456789);
  message.name(name.c_str());
  message.probability(0.75);
  return message;
}

TEST_F(Raw, DiscoveryTellsTypeKeyAndQosOfATopic) {
  Collector<DiscoveredWriter> found;
  Discovery discovery([&](const DiscoveredWriter& one) { found.add(one); });
  const Participant listener = join("", &discovery);
  Participant lab = join("");
  auto commands = lab.writer(robot_command);
  auto clock = lab.writer(lab_clock);
  ASSERT_TRUE(commands && clock);
  DiscoveredWriter command, tick;
  ASSERT_TRUE(match(command, found, "robot/command"));
  ASSERT_TRUE(match(tick, found, "lab/clock"));
  EXPECT_EQ(command.topic.type, "prehend::v2::HandCommand");
  EXPECT_TRUE(command.topic.keyed);
  EXPECT_FALSE(tick.topic.keyed);
  EXPECT_EQ(command.rigs, std::vector{rig});
  EXPECT_TRUE(command.topic.qos.reliable);
  EXPECT_FALSE(command.topic.qos.transient_local);
  EXPECT_EQ(command.topic.qos.exclusive_ownership, robot_command.qos.exclusive_ownership);
  EXPECT_EQ(command.topic.qos.deadline, std::chrono::milliseconds(100));
  EXPECT_EQ(command.topic.qos.lifespan, std::chrono::milliseconds(200));
  EXPECT_EQ(command.topic.qos.writer_depth, 64);
  EXPECT_EQ(tick.topic.qos.writer_depth, 0);
}

TEST_F(Raw, BytesKeysEndsAndStampsPassThrough) {
  Collector<DiscoveredWriter> found;
  Discovery discovery([&](const DiscoveredWriter& one) { found.add(one); });
  Participant recorder = join("a", &discovery);
  Participant lab = join("a");
  auto writer = lab.writer(object_detection);
  ASSERT_TRUE(writer);
  DiscoveredWriter topic;
  ASSERT_TRUE(match(topic, found, "object/detection"));
  Collector<RawSample> taken;
  auto reader = RawReader::create(recorder, topic.topic,
                                  [&](RawSample&& sample) { taken.add(std::move(sample)); });
  ASSERT_TRUE(reader) << reader.error().message();
  meet(writer->raw());
  ASSERT_TRUE(met(**reader));

  ASSERT_TRUE(writer->write(raw_detection(4, "Talc")));
  ASSERT_TRUE(writer->write(raw_detection(7, "Cup")));
  ASSERT_TRUE(writer->dispose(raw_detection(4, "")));
  ASSERT_TRUE(writer->write(raw_detection(4, "Talc again")));
  ASSERT_TRUE(writer->write(raw_detection(7, std::string(60, 'x'))));
  const auto first = taken.wait(5);
  ASSERT_EQ(first.size(), 5u);
  EXPECT_EQ(first[2].kind, Kind::disposed);
  EXPECT_EQ(first[2].instance, first[0].instance);
  EXPECT_NE(first[0].instance, first[1].instance);
  EXPECT_EQ(first[3].instance, first[0].instance);
  EXPECT_GE(first[0].received, first[0].sent);
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].sequence, i + 1);

  // Again, elsewhere: written raw, read raw and typed.
  Participant player = join("b"), listener = join("b");
  Collector<RawSample> again;
  auto second_reader = RawReader::create(listener, topic.topic,
                                         [&](RawSample&& sample) { again.add(std::move(sample)); });
  Participant viewer = join("b");
  auto typed = viewer.reader(object_detection);
  auto raw = RawWriter::create(player, topic.topic);
  ASSERT_TRUE(raw && typed && second_reader);
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  eprosima::fastdds::dds::PublicationMatchedStatus status;
  while (status.current_count < 2 && std::chrono::steady_clock::now() < give_up)
    raw->raw().get_publication_matched_status(status);
  ASSERT_TRUE(met(**second_reader));
  for (const RawSample& sample : first) EXPECT_TRUE(raw->write(sample, sample.sent));
  const auto second = again.wait(5);
  ASSERT_EQ(second.size(), 5u);
  for (std::size_t i = 0; i < second.size(); ++i) {
    EXPECT_EQ(second[i].kind, first[i].kind) << i;
    EXPECT_EQ(second[i].payload, first[i].payload) << i;
    EXPECT_EQ(second[i].instance, first[i].instance) << i;
    EXPECT_EQ(second[i].sent, first[i].sent) << i;
  }
  std::map<std::uint32_t, std::string> names;
  while (names.size() < 2 || names[7].size() != 60) {
    ASSERT_TRUE(typed->raw().wait_for_unread_message({5, 0}));
    for (const auto& sample : typed->take())
      if (!sample.info.gone) names[sample.data.track()] = sample.data.name().to_string();
  }
  EXPECT_EQ(names[4], "Talc again");
}

TEST_F(Raw, DisposeAndUnregisterAreKeptApart) {
  Participant player = join(""), listener = join("");
  const RawTopic topic{
      .name = "some/topic", .type = "some::Type", .keyed = true, .qos = {.writer_depth = 0}};
  Collector<RawSample> taken;
  auto reader =
      RawReader::create(listener, topic, [&](RawSample&& sample) { taken.add(std::move(sample)); });
  auto writer = RawWriter::create(player, topic);
  ASSERT_TRUE(reader && writer);
  meet(writer->raw());
  const auto change = [](std::uint8_t key, Kind kind) {
    RawSample sample;
    sample.kind = kind;
    sample.instance[0] = key;
    if (kind == Kind::data) sample.payload = {0, 1, 0, 0, key, 2, 3, 4};
    return sample;
  };
  std::vector<RawSample> sent;
  for (const auto& [key, kind] : std::vector<std::pair<int, Kind>>{{1, Kind::data},
                                                                   {2, Kind::data},
                                                                   {1, Kind::unregistered},
                                                                   {2, Kind::disposed},
                                                                   {1, Kind::data},
                                                                   {2, Kind::unregistered},
                                                                   {1, Kind::disposed},
                                                                   {1, Kind::data},
                                                                   {3, Kind::data}})
    sent.push_back(change(static_cast<std::uint8_t>(key), kind));
  for (std::size_t i = 0; i < sent.size(); ++i)
    ASSERT_TRUE(writer->write(sent[i], from_ns(1'700'000'000'123'456'789 + static_cast<int>(i))));
  const auto got = taken.wait(sent.size());
  ASSERT_EQ(got.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(got[i].kind, sent[i].kind) << i;
    EXPECT_EQ(got[i].instance, sent[i].instance) << i;
    EXPECT_EQ(got[i].payload, sent[i].payload) << i;
    EXPECT_EQ(to_ns(got[i].sent), 1'700'000'000'123'456'789 + static_cast<int>(i));
  }
}

// Fast DDS hands on instance by instance what has come at once, as all does that comes to a late
// joiner: recordings would tell of it in another order on a busy machine.
TEST_F(Raw, WhatComesAtOnceComesInTheOrderItWasWritten) {
  Participant player = join(""), listener = join("");
  const RawTopic topic{.name = "some/topic",
                       .type = "some::Type",
                       .keyed = true,
                       .qos = {.transient_local = true, .writer_depth = 0}};
  auto writer = RawWriter::create(player, topic);
  ASSERT_TRUE(writer);
  constexpr std::size_t count = 60;
  for (std::size_t i = 0; i < count; ++i) {
    RawSample sample;
    sample.instance[0] = static_cast<std::uint8_t>(i % 3);
    sample.payload = {0, 1, 0, 0, sample.instance[0], 2, 3, 4};
    ASSERT_TRUE(writer->write(sample, from_ns(1'700'000'000'000'000'000 + static_cast<int>(i))));
  }
  Collector<RawSample> taken;
  auto reader =
      RawReader::create(listener, topic, [&](RawSample&& sample) { taken.add(std::move(sample)); });
  ASSERT_TRUE(reader);
  const auto got = taken.wait(count);
  ASSERT_EQ(got.size(), count);
  for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(got[i].instance[0], i % 3) << i;
}

TEST_F(Raw, WhatAKeepLastWriterHasForgottenIsNoLoss) {
  Participant lab = join(""), listener = join("");
  auto writer = lab.writer(object_detection);
  ASSERT_TRUE(writer);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(writer->write(raw_detection(1, "Cup")));
  Collector<RawSample> taken;
  const RawTopic topic{.name = "object/detection",
                       .type = "prehend::v1::ObjectDetection",
                       .qos = {.transient_local = true}};
  auto reader =
      RawReader::create(listener, topic, [&](RawSample&& sample) { taken.add(std::move(sample)); });
  ASSERT_TRUE(reader);
  ASSERT_EQ(taken.wait(1).size(), 1u);
  ASSERT_TRUE(writer->write(raw_detection(2, "Talc")));
  EXPECT_EQ(taken.wait(2).size(), 2u);
  EXPECT_EQ((*reader)->lost(), 0u);
  EXPECT_EQ((*reader)->received(), 2u);
}

// Recordings are read by whoever got them from somewhere: what is damaged in them is refused and
// does not end the process.
TEST(Decode, RefusesWhatIsDamaged) {
  v2::HandCommand message, decoded;
  message.hand("hand");
  message.dof({0.1, 0.2});
  RawSample sample;
  sample.payload = encode(robot_command, message);
  ASSERT_TRUE(decode(robot_command, sample, decoded));
  EXPECT_EQ(decoded, message);
  const auto refused = [&](auto damage) {
    RawSample damaged = sample;
    damage(damaged.payload);
    return !decode(robot_command, damaged, decoded);
  };
  EXPECT_TRUE(refused([](auto& bytes) { bytes[0] = bytes[1] = 0xff; }));  // no encapsulation
  EXPECT_TRUE(refused([](auto& bytes) { bytes.resize(3); }));
  EXPECT_TRUE(refused([](auto& bytes) { bytes.clear(); }));
  // Also between two members: Fast CDR 2 would take what is there, and leave the rest as it was.
  for (std::size_t length = 3; length < sample.payload.size(); ++length)
    EXPECT_TRUE(refused([&](auto& bytes) { bytes.resize(length); })) << length;
}

long peak_memory() {  // kB
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return used.ru_maxrss;
}

// Guards: in the second representation Fast CDR 2 made room for as many sensors as were said to
// come, 150 GB for one damaged byte.
TEST(Decode, ADamagedLengthTakesNoMemory) {
  v1::GloveFrame message, decoded;
  message.sensors().resize(2);
  const auto bytes = encode(glove_frame, message);
  const long before = peak_memory();
  for (std::uint8_t kind = 0; kind < 12; ++kind)
    for (std::size_t at = 4; at + 4 <= bytes.size(); ++at) {
      RawSample damaged;
      damaged.payload = bytes;
      damaged.payload[1] = kind;
      std::fill_n(damaged.payload.begin() + static_cast<std::ptrdiff_t>(at), 4, 0);
      damaged.payload[at + 2] = 0x40;  // four million, 300 MB of sensors
      (void)decode(glove_frame, damaged, decoded);
    }
  EXPECT_LT(peak_memory() - before, 100'000);
}

}  // namespace
}  // namespace prehend::dds
