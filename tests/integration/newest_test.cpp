// After a cable was out the newest sample of each instance is there, of every reliable topic with
// the QoS that it has in the lab, whatever of the older ones a history of that depth had to let go;
// of topics that keep all nothing is missing. Writer and reader sit on two hosts.
#include <cstring>
#include <mutex>
#include <thread>

#include "common/dds/raw.hpp"
#include "tests/integration/fault_rig.hpp"

namespace prehend::integration {
namespace {

constexpr double newest_healed = 1.0;  // s
constexpr std::uint8_t instances = 5;

/// Both ends of a topic; the samples of an instance are numbered from 1.
struct Line {
  const dds::TopicInfo& topic;
  std::optional<dds::RawWriter> writer;
  std::unique_ptr<dds::RawReader> reader;
  std::mutex mutex;
  std::map<std::uint8_t, std::uint64_t> newest, count;

  void hear(const dds::RawSample& sample) {
    if (sample.kind != dds::RawSample::Kind::data) return;
    std::uint64_t number = 0;
    std::memcpy(&number, sample.payload.data() + 8, sizeof number);
    const std::scoped_lock lock(mutex);
    newest[sample.payload[4]] = std::max(newest[sample.payload[4]], number);
    ++count[sample.payload[4]];
  }
  void write(std::uint8_t instance, std::uint64_t number) {
    dds::RawSample sample;
    sample.payload = {0, 1, 0, 0, instance, 0, 0, 0};
    sample.payload.resize(16);
    std::memcpy(sample.payload.data() + 8, &number, sizeof number);
    sample.instance[0] = instance;
    writer->write(sample, from_ns(now_ns()));
  }
  bool has_all(std::uint64_t number) {
    const std::scoped_lock lock(mutex);
    for (std::uint8_t i = 0; i < instances; ++i)
      if (newest[i] < number || (topic.qos.writer_depth == 0 && count[i] < number)) return false;
    return true;
  }
};

class Newest : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto why = Hosts::unavailable()) GTEST_SKIP() << *why;
    hosts_.emplace();
    for (const char* name : {"here", "there"}) hosts_->add(name);
    for (std::size_t i = 0; i < 2; ++i)
      std::thread([&, i] {
        hosts_->enter_for_good(i == 0 ? "here" : "there");
        auto made = dds::Participant::create(
            {.name = "end", .domain = domain_, .rig = "newest", .network = {.profile = "lan"}});
        if (made) ends_[i].emplace(std::move(*made));
      }).join();
    ASSERT_TRUE(ends_[0] && ends_[1]);
  }
  void TearDown() override {
    lines_.clear();
    for (auto& end : ends_) end.reset();
  }

  const test::DomainLease lease_;
  const int domain_ = lease_.domain();
  std::optional<Hosts> hosts_;
  std::array<std::optional<dds::Participant>, 2> ends_;
  std::vector<std::unique_ptr<Line>> lines_;
};

TEST_F(Newest, SampleOfEachInstanceArrivesWhenTheCableIsBack) {
  for (const dds::TopicInfo& topic : dds::topic_table) {
    if (!topic.qos.reliable) continue;
    auto line = std::make_unique<Line>(topic);
    Line* raw = line.get();
    const dds::RawTopic there{std::string(topic.name), "numbered", true, topic.qos};
    auto reader =
        dds::RawReader::create(*ends_[1], there, [raw](dds::RawSample&& s) { raw->hear(s); });
    auto writer = dds::RawWriter::create(*ends_[0], there);
    ASSERT_TRUE(reader && writer) << topic.name;
    line->reader = std::move(*reader);
    line->writer.emplace(std::move(*writer));
    lines_.push_back(std::move(line));
  }
  ASSERT_GE(lines_.size(), 8u);
  for (const auto& line : lines_)
    ASSERT_TRUE(eventually(10, [&] {
      eprosima::fastdds::dds::PublicationMatchedStatus matched;
      line->writer->raw().get_publication_matched_status(matched);
      return matched.current_count > 0 && line->reader->writers() > 0;
    })) << line->topic.name;
  FaultRow row;
  row.fault = "cable pulled, every reliable topic";
  std::uint64_t number = 0;
  const auto write_for = [&](double limit_s, const std::function<bool()>& enough) {
    const std::int64_t begin = now_ns();
    while (!enough() && static_cast<double>(now_ns() - begin) * 1e-9 < limit_s) {
      ++number;
      for (const auto& line : lines_)
        for (std::uint8_t i = 0; i < instances; ++i) line->write(i, number);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return static_cast<double>(now_ns() - begin) * 1e-9;
  };
  const auto never = [] { return false; };
  write_for(0.3, never);
  for (row.rounds = 0; row.rounds < rounds(1, 10); ++row.rounds) {
    hosts_->link("here", false);
    write_for(rounds(2, 10), never);
    hosts_->link("here", true);
    const std::uint64_t due = number;
    row.recoveries.push_back(write_for(10, [&] {
      return std::all_of(lines_.begin(), lines_.end(),
                         [&](const auto& line) { return line->has_all(due); });
    }));
    for (const auto& line : lines_) EXPECT_TRUE(line->has_all(due)) << line->topic.name;
    EXPECT_LT(row.recoveries.back(), promised(newest_healed));
  }
  for (const auto& line : lines_)
    if (line->topic.qos.writer_depth == 0) row.lost += line->reader->lost();
  EXPECT_EQ(row.lost, 0u);
  report(row);
}

// An order ends as it is given, and both may be lost and sent again out of order.
TEST_F(Newest, OrdersAllArriveThoughPacketsAreLost) {
  auto writer = ends_[0]->writer(dds::operator_command);
  auto reader = ends_[1]->reader(dds::operator_command);
  ASSERT_TRUE(writer && reader);
  ASSERT_TRUE(eventually(10, [&] {
    eprosima::fastdds::dds::SubscriptionMatchedStatus there;
    reader->raw().get_subscription_matched_status(there);
    eprosima::fastdds::dds::PublicationMatchedStatus here;
    writer->raw().get_publication_matched_status(here);
    return here.current_count > 0 && there.current_count > 0;
  }));
  for (const char* host : {"here", "there"}) hosts_->lose(host, 0.05);
  std::vector<int> came;
  const auto take = [&] {
    for (const auto& sample : reader->take()) {
      EXPECT_FALSE(sample.info.gone);
      came.push_back(std::stoi(sample.data.id().to_string()));
    }
    return came.size();
  };
  const int count = rounds(500, 20'000);
  for (int i = 0; i < count; ++i) {
    v1::OperatorCommand order;
    order.id(std::to_string(i));
    ASSERT_TRUE(writer->write(order));
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    take();
  }
  for (const char* host : {"here", "there"}) hosts_->lose(host, 0);
  EXPECT_TRUE(eventually(10, [&] { return take() >= static_cast<std::size_t>(count); }))
      << came.size() << " of " << count;
  std::sort(came.begin(), came.end());
  for (int i = 0; i < std::min(count, static_cast<int>(came.size())); ++i)
    ASSERT_EQ(came[static_cast<std::size_t>(i)], i) << "lost, or came twice";
}

// The news that a participant leaves used to overtake its last order, which was then lost to half
// of its readers.
TEST_F(Newest, AnOrderIsHeardWhoseGiverLeavesAtOnce) {
  auto reader = ends_[1]->reader(dds::operator_command);
  ASSERT_TRUE(reader);
  for (int i = 0; i < rounds(20, 500); ++i) {
    std::optional<dds::Participant> giver;
    std::thread([&] {
      hosts_->enter_for_good("here");
      auto made = dds::Participant::create(
          {.name = "giver", .domain = domain_, .rig = "newest", .network = {.profile = "lan"}});
      if (made) giver.emplace(std::move(*made));
    }).join();
    ASSERT_TRUE(giver);
    auto writer = giver->writer(dds::operator_command);
    ASSERT_TRUE(writer);
    ASSERT_TRUE(eventually(10, [&] {
      eprosima::fastdds::dds::SubscriptionMatchedStatus there;
      reader->raw().get_subscription_matched_status(there);
      eprosima::fastdds::dds::PublicationMatchedStatus here;
      writer->raw().get_publication_matched_status(here);
      return here.current_count > 0 && there.total_count == i + 1;
    }));
    for (const char* host : {"here", "there"}) hosts_->lose(host, 0.05);
    v1::OperatorCommand order;
    order.id(std::to_string(i));
    ASSERT_TRUE(writer->write(order));
    giver.reset();
    std::string heard;
    EXPECT_TRUE(eventually(15, [&] {
      for (const auto& sample : reader->take())
        if (!sample.info.gone) heard = sample.data.id().to_string();
      return heard == std::to_string(i);
    })) << i;
    for (const char* host : {"here", "there"}) hosts_->lose(host, 0);
  }
}

}  // namespace
}  // namespace prehend::integration
