// After a cable was out the newest sample of each instance is there, of every reliable topic with
// the QoS that it has in the lab, whatever of the older ones a history of that depth had to let go;
// of topics that keep all nothing is missing. Writer and reader sit on two hosts.
#include <sys/stat.h>

#include <fstream>
#include <mutex>
#include <sstream>
#include <thread>

#include "tests/integration/fault_rig.hpp"
#include "tests/integration/numbered.hpp"
#include "tests/support/paths/paths.hpp"

namespace prehend::integration {
namespace {

constexpr double newest_healed = 1.0;  // s

/// What has come of a topic, whose samples are numbered from 1.
struct Line {
  dds::RawTopic topic;
  std::unique_ptr<dds::RawReader> reader;
  std::mutex mutex;
  std::array<std::uint64_t, instances> newest{}, count{};

  void hear(const dds::RawSample& sample) {
    if (sample.kind != dds::RawSample::Kind::data) return;
    const auto [instance, number] = numbered(sample);
    const std::scoped_lock lock(mutex);
    newest[instance] = std::max(newest[instance], number);
    ++count[instance];
  }
  bool has_all(std::uint64_t number) {
    const std::scoped_lock lock(mutex);
    for (std::uint8_t i = 0; i < instances; ++i)
      if (newest[i] < number || (topic.qos.writer_depth == 0 && count[i] < number)) return false;
    return true;
  }
};

/// The process prehend-numbering on the other host.
class Writing {
 public:
  Writing(const Hosts& hosts, int domain, const std::string& what)
      : folder_(std::filesystem::temp_directory_path() /
                ("prehend-numbering-" + std::to_string(now_ns()))) {
    std::filesystem::create_directories(folder_);
    const std::string fifo = folder_ / "numbers";
    if (::mkfifo(fifo.c_str(), 0600) != 0) throw std::runtime_error(fifo + ": cannot be made");
    numbers_.open(fifo, std::ios::in | std::ios::out);  // both: it waits for nobody to read
    auto process =
        stage::Process::start({.command = hosts.on("here", {test::in_programs("prehend-numbering"),
                                                            std::to_string(domain), what, fifo}),
                               .log = folder_ / "log"});
    if (!process) throw std::runtime_error(process.error().message());
    process_.emplace(std::move(*process));
  }
  ~Writing() { std::filesystem::remove_all(folder_); }
  Writing(const Writing&) = delete;
  Writing& operator=(const Writing&) = delete;

  bool is_met() const {
    std::stringstream log;
    log << std::ifstream(folder_ / "log").rdbuf();
    return log.str().find("met\n") != std::string::npos;
  }
  void write(std::uint64_t number) { numbers_ << number << std::endl; }
  /// Leaves as soon as it has written what was given to it.
  void leave() { numbers_.close(); }

 private:
  std::filesystem::path folder_;
  std::fstream numbers_;
  std::optional<stage::Process> process_;
};

class Newest : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto why = Hosts::unavailable()) GTEST_SKIP() << *why;
    hosts_.emplace();
    for (const char* name : {"here", "there"}) hosts_->add(name);
    std::thread([&] {
      hosts_->enter_for_good("there");
      auto made = dds::Participant::create(
          {.name = "end", .domain = domain_, .rig = "newest", .network = {.profile = "lan"}});
      if (made) end_.emplace(std::move(*made));
    }).join();
    ASSERT_TRUE(end_);
  }

  const test::DomainLease lease_;
  const int domain_ = lease_.domain();
  std::optional<Hosts> hosts_;
  std::optional<dds::Participant> end_;
  std::vector<std::unique_ptr<Line>> lines_;  // end before their participant
};

TEST_F(Newest, SampleOfEachInstanceArrivesWhenTheCableIsBack) {
  for (const dds::RawTopic& topic : numbered_topics()) {
    auto line = std::make_unique<Line>();
    line->topic = topic;
    Line* raw = line.get();
    auto reader = dds::RawReader::create(*end_, topic, [raw](dds::RawSample&& s) { raw->hear(s); });
    ASSERT_TRUE(reader) << topic.name;
    line->reader = std::move(*reader);
    lines_.push_back(std::move(line));
  }
  ASSERT_GE(lines_.size(), 8u);
  Writing far(*hosts_, domain_, "samples");
  for (const auto& line : lines_)
    ASSERT_TRUE(eventually(10, [&] { return far.is_met() && line->reader->writers() > 0; }))
        << line->topic.name;
  FaultRow row;
  row.fault = "cable pulled, every reliable topic";
  std::uint64_t number = 0;
  const auto write_for = [&](double limit_s, const std::function<bool()>& enough) {
    const std::int64_t begin = now_ns();
    while (!enough() && static_cast<double>(now_ns() - begin) * 1e-9 < limit_s) {
      far.write(++number);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return static_cast<double>(now_ns() - begin) * 1e-9;
  };
  const auto never = [] { return false; };
  const auto all_have = [&](std::uint64_t due) {
    return std::all_of(lines_.begin(), lines_.end(),
                       [&](const auto& line) { return line->has_all(due); });
  };
  write_for(0.3, never);
  for (row.rounds = 0; row.rounds < rounds(1, 10); ++row.rounds) {
    hosts_->link("here", false);
    write_for(rounds(2, 10), never);
    const std::uint64_t due = number;
    ASSERT_FALSE(all_have(due)) << "the cable is out, and all has come";
    hosts_->link("here", true);
    row.recoveries.push_back(write_for(10, [&] { return all_have(due); }));
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
  auto reader = end_->reader(dds::operator_command);
  ASSERT_TRUE(reader);
  Writing far(*hosts_, domain_, "orders");
  ASSERT_TRUE(eventually(10, [&] {
    eprosima::fastdds::dds::SubscriptionMatchedStatus there;
    reader->raw().get_subscription_matched_status(there);
    return far.is_met() && there.current_count > 0;
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
    far.write(static_cast<std::uint64_t>(i));
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
  auto reader = end_->reader(dds::operator_command);
  ASSERT_TRUE(reader);
  for (int i = 0; i < rounds(20, 500); ++i) {
    Writing giver(*hosts_, domain_, "orders");
    ASSERT_TRUE(eventually(10, [&] {
      eprosima::fastdds::dds::SubscriptionMatchedStatus there;
      reader->raw().get_subscription_matched_status(there);
      return giver.is_met() && there.total_count == i + 1;
    }));
    for (const char* host : {"here", "there"}) hosts_->lose(host, 0.05);
    giver.write(static_cast<std::uint64_t>(i));
    giver.leave();
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
