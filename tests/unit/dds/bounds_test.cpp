// Nothing grows with time: instances come and go without number, and neither writers nor readers
// keep anything of those that have gone. Memory is compared between one run of many instances and
// the next one of as many, because the allocator and Fast DDS take what they need in the first, and
// again where more was on its way at once than ever before. What leaks grows with every run: by 200
// bytes or more an instance, it shows.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <limits>

#include "common/dds/participant.hpp"
#include "common/dds/raw.hpp"
#include "tests/support/domains/domain_lease.hpp"

namespace prehend::dds {
namespace {

const int many = std::getenv("PREHEND_LONG") ? 50'000 : 5'000;
constexpr double min_leak = 200;  // bytes for each instance

double resident() {
  std::ifstream statm("/proc/self/statm");
  long total = 0, resident = 0;
  statm >> total >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

class Bounds : public testing::Test {
 protected:
  Participant join(const std::string& name) {
    auto made = Participant::create({.name = name, .domain = domain_, .rig = rig_});
    EXPECT_TRUE(made) << made.error().message();
    return std::move(*made);
  }
  static bool eventually(const std::function<bool()>& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
  }
  template <class T>
  static void meet(Writer<T>& writer, int readers = 1) {
    ASSERT_TRUE(eventually([&] {
      eprosima::fastdds::dds::PublicationMatchedStatus status;
      writer.raw().get_publication_matched_status(status);
      return status.current_count >= readers;
    }));
  }
  /// Bytes for each instance by which the best of up to four more runs grew.
  static double growth(int count, const std::function<void()>& run) {
    run();
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 4 && least >= min_leak && !HasFailure(); ++i) {
      const double before = resident();
      run();
      least = std::min(least, (resident() - before) / count);
    }
    return least;
  }

  const test::DomainLease lease_;
  const int domain_ = lease_.domain();
  std::string rig_ = "bounds-" + std::to_string(getpid());
};

TEST_F(Bounds, NothingIsKeptOfOrdersAndNoneIsLost) {
  Participant one = join("operator"), other = join("mapping");
  auto writer = *one.writer(operator_command);
  auto reader = *other.reader(operator_command);
  meet(writer);
  // A recorder of any topic is there as well.
  Participant third = join("recorder");
  std::atomic<int> recorded = 0;
  auto raw = RawReader::create(third, raw_topic(operator_command), [&](RawSample&& sample) {
    recorded += sample.kind == RawSample::Kind::data;
  });
  ASSERT_TRUE(raw);
  meet(writer, 2);
  int given = 0, heard = 0;
  const double grew = growth(many, [&] {
    for (int i = 0; i < many; ++i) {
      v1::OperatorCommand command;
      command.id("order-" + std::to_string(++given));
      ASSERT_TRUE(writer.write(command));
      for (const auto& sample : reader.take()) {
        EXPECT_FALSE(sample.info.gone);
        heard += !sample.info.gone;
      }
    }
    EXPECT_TRUE(eventually([&] {
      heard += static_cast<int>(reader.take().size());
      return heard == given && recorded == given;
    })) << heard
        << " and " << recorded << " of " << given;
  });
  EXPECT_LE(reader.instances(), 1u);
  EXPECT_LT(grew, min_leak) << "bytes for each order";
  EXPECT_EQ((*raw)->lost(), 0u);
  std::cout << grew << " bytes for each order\n";
}

TEST_F(Bounds, ATrackThatIsGoneIsForgottenByAllAndUnknownToLateReaders) {
  Participant one = join("recognition"), other = join("mapping");
  auto writer = *one.writer(object_detection);
  auto reader = *other.reader(object_detection);
  meet(writer);
  const auto detection = [](std::uint32_t track) {
    v1::ObjectDetection message;
    message.track(track);
    return message;
  };
  std::uint32_t track = 0, gone = 0, seen = 0;  // a take is ordered by instance
  const auto take = [&] {
    for (const auto& sample : reader.take()) {
      gone += sample.info.gone;
      if (sample.data.track() == track) seen = track;
    }
  };
  ASSERT_TRUE(writer.write(detection(4'000'000'000)));  // stays
  const double grew = growth(many, [&] {
    for (int i = 0; i < many; ++i) {
      ASSERT_TRUE(writer.write(detection(++track)));
      // A reader of the last sample alone need not see a track that is gone before it was taken.
      if (i % 50 == 0) {
        ASSERT_TRUE(eventually([&] {
          take();
          return seen == track;
        }));
        EXPECT_GT(reader.instances(), 1u);
      }
      ASSERT_TRUE(writer.dispose(detection(track)));
    }
    EXPECT_TRUE(eventually([&] {
      take();
      return reader.instances() == 1;
    })) << reader.instances();
  });
  EXPECT_LT(grew, min_leak) << "bytes for each track";
  std::cout << grew << " bytes for each track\n";
  EXPECT_GE(gone, static_cast<std::uint32_t>(2 * many / 50));
  Participant third = join("late");
  auto late = *third.reader(object_detection);
  std::size_t told = 0;
  EXPECT_TRUE(eventually([&] {
    told += late.take().size();
    return told > 0;
  }));
  EXPECT_EQ(late.instances(), 1u);
}

TEST_F(Bounds, OfReportsALateReaderGetsTheLastAndAReaderWhoIsThereGetsAll) {
  Participant one = join("simulation"), other = join("viewer");
  auto writer = *one.writer(grasp_report);
  auto reader = *other.reader(grasp_report);
  meet(writer);
  std::uint64_t number = 0, next = 1;
  const auto take = [&] {
    for (const auto& sample : reader.take()) {
      EXPECT_EQ(sample.data.sequence_number(), next) << "lost";
      next = sample.data.sequence_number() + 1;
    }
    return next == number + 1;
  };
  const double grew = growth(many, [&] {
    for (int i = 0; i < many; ++i) {
      v1::GraspReport report;
      report.hand("hand");
      report.sequence_number(++number);
      ASSERT_TRUE(writer.write(report));
      if (i % 100 == 0) {
        EXPECT_TRUE(eventually(take));
      }
    }
    EXPECT_TRUE(eventually(take));
  });
  EXPECT_LT(grew, min_leak) << "bytes for each report";
  std::cout << grew << " bytes for each report\n";
  Participant third = join("late");
  auto late = *third.reader(grasp_report);
  std::vector<std::uint64_t> told;
  const auto kept = static_cast<std::size_t>(grasp_report.qos.writer_depth);
  EXPECT_TRUE(eventually([&] {
    for (const auto& sample : late.take()) told.push_back(sample.data.sequence_number());
    return told.size() >= kept;
  })) << told.size();
  ASSERT_EQ(told.size(), kept);
  EXPECT_EQ(told.back(), number);
  EXPECT_EQ(told.front(), number - kept + 1);
}

}  // namespace
}  // namespace prehend::dds
