// Shared work is done once each, whatever the number of threads, and an exception comes out.
#include "common/base/workers.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace prehend {
namespace {

TEST(ShareWork, DoesEachPieceOnceAndTellsTheLast) {
  for (const unsigned threads : {0u, 1u, 2u, 7u, ~0u}) {  // the last: more than a machine can
    for (const std::size_t count : {0u, 1u, 5u, 100u}) {
      std::vector<std::atomic<int>> done(count);
      std::size_t told = 0;
      share_work(
          count, threads, [&](std::size_t i) { ++done[i]; },
          [&](std::size_t n) {
            EXPECT_GT(n, told);
            told = n;
          });
      EXPECT_EQ(told, count);
      for (const auto& times : done) EXPECT_EQ(times, 1);
    }
  }
}

TEST(ShareWork, ThrowsOnWhatTheWorkThrows) {
  EXPECT_THROW(share_work(
                   10, 2,
                   [](std::size_t i) {
                     if (i == 3) throw std::runtime_error("no");
                   },
                   [](std::size_t) {}),
               std::runtime_error);
}

}  // namespace
}  // namespace prehend
