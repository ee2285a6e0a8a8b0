// Security.ThoseWhoComeAndGoLockNobodyUp locked a process up in every second run until two
// functions of Fast DDS 2.9.1 were called through ours. Nothing but the loader sees to that.
#include "common/dds/guard/handshake_pause.hpp"

#include <gtest/gtest.h>

#include "common/dds/release/fastdds.hpp"

namespace prehend::dds {
namespace {

TEST(HandshakePause, StandsBeforeFastDds) {
  EXPECT_EQ(handshakes_pause_for_removals(), PREHEND_FAST_DDS == 2);
}

}  // namespace
}  // namespace prehend::dds
