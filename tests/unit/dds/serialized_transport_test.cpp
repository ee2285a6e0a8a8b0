// One at a time: while a packet is in the serializer nobody else is, and after it is closed nobody.
// A packet that stays there is noticed, a process that is merely busy with ever new ones is not.
#include "common/dds/guard/serialized_transport.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <thread>
#include <vector>

namespace prehend::dds {
namespace {

TEST(SerializedTransport, LetsOneInAtATime) {
  SerializedTransport serializer;
  int inside = 0, most = 0, passed = 0;  // not atomic: the serializer guards them
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&] {
        for (int i = 0; i < 1000; ++i)
          serializer.pass([&] {
            most = std::max(most, ++inside);
            std::this_thread::yield();
            --inside;
            ++passed;
          });
      });
  }
  EXPECT_EQ(most, 1);
  EXPECT_EQ(passed, 4000);
}

TEST(SerializedTransport, ClosedOnlyWhenNobodyIsInItThenForGood) {
  SerializedTransport serializer;
  bool entered = false, let_go = false, left = false;
  std::mutex mutex;
  std::condition_variable news;
  std::jthread packet([&] {
    serializer.pass([&] {
      std::unique_lock lock(mutex);
      entered = true;
      news.notify_all();
      news.wait(lock, [&] { return let_go; });
      left = true;
    });
  });
  {
    std::unique_lock lock(mutex);
    news.wait(lock, [&] { return entered; });
    let_go = true;
    news.notify_all();
  }
  serializer.close();
  EXPECT_TRUE(left);
  serializer.pass([] { ADD_FAILURE() << "closed"; });
}

TEST(SerializedTransport, APacketThatStaysIsNoticed) {
  SerializedTransport serializer;
  DeadlockWatchdog watch;
  for (int look = 0; look < 3 * DeadlockWatchdog::max_looks; ++look)
    serializer.pass([&] { EXPECT_FALSE(watch.look()) << "another packet at each look"; });
  serializer.pass([&] {
    EXPECT_EQ(packets_in_process().size(), 1u);
    for (int look = 1; look < DeadlockWatchdog::max_looks; ++look)
      EXPECT_FALSE(watch.look()) << look;
    EXPECT_TRUE(watch.look());
  });
  EXPECT_FALSE(watch.look());
  EXPECT_TRUE(packets_in_process().empty());
}

}  // namespace
}  // namespace prehend::dds
