// One at a time: while a packet is in the gate nobody else is, and after it is closed nobody. A
// packet that stays there is noticed, a process that is merely busy with ever new ones is not.
#include <gtest/gtest.h>

#include <condition_variable>
#include <prehend/dds/gate.hpp>
#include <thread>
#include <vector>

namespace prehend::dds {
namespace {

TEST(Gate, LetsOneInAtATime) {
  Gate gate;
  int inside = 0, most = 0, passed = 0;  // not atomic: the gate guards them
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&] {
        for (int i = 0; i < 1000; ++i)
          gate.pass([&] {
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

TEST(Gate, ClosedOnlyWhenNobodyIsInItThenForGood) {
  Gate gate;
  bool entered = false, let_go = false, left = false;
  std::mutex mutex;
  std::condition_variable news;
  std::jthread packet([&] {
    gate.pass([&] {
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
  gate.close();
  EXPECT_TRUE(left);
  gate.pass([] { ADD_FAILURE() << "closed"; });
}

TEST(Gate, APacketThatStaysIsNoticed) {
  Gate gate;
  DeafnessWatch watch;
  for (int look = 0; look < 3 * DeafnessWatch::most; ++look)
    gate.pass([&] { EXPECT_FALSE(watch.look()) << "another packet at each look"; });
  gate.pass([&] {
    EXPECT_EQ(packets_in_hand().size(), 1u);
    for (int look = 1; look < DeafnessWatch::most; ++look) EXPECT_FALSE(watch.look()) << look;
    EXPECT_TRUE(watch.look());
  });
  EXPECT_FALSE(watch.look());
  EXPECT_TRUE(packets_in_hand().empty());
}

}  // namespace
}  // namespace prehend::dds
