#include "common/dds/dds_log.hpp"

#include <gtest/gtest.h>

#include <fastdds/dds/log/Log.hpp>

#include "common/dds/release/fastdds.hpp"

namespace prehend::dds {
namespace {

using eprosima::fastdds::dds::Log;

void say(const char* category, const std::string& message) {
  Log::QueueLog(message, Log::Context{__FILE__, __LINE__, __func__, category}, Log::Kind::Error);
  Log::Flush();
}

// Of Fast DDS 3.1 no other word tells that nobody can join any more.
TEST(DdsLog, HearsThatHandshakesAreUsedUp) {
  DdsLog::install();
  say("SECURITY", "something else");
  say("RTPS_WRITER", "WriterHistory cannot add the CacheChange_t");
  EXPECT_FALSE(handshakes_are_used_up());
  say("SECURITY", "WriterHistory cannot add the CacheChange_t");
  EXPECT_EQ(handshakes_are_used_up(), PREHEND_FAST_DDS > 2);
}

}  // namespace
}  // namespace prehend::dds
