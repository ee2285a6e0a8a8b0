// At the port of a glove somebody else is plugged in: one line says who, for each serial device.
#include "tests/support/strange_port.hpp"

#include <gmock/gmock.h>

#include "tests/unit/glove_devices/listener.hpp"

namespace prehend::glove {
namespace {

TEST(StrangePort, EachSerialDeviceSaysWhoSpeaksInstead) {
  int tried = 0;
  for (const DeviceKind& kind : device_kinds()) {
    if (kind.line != Line::serial) continue;
    for (const test::Stranger who : test::all_strangers) {
      const test::StrangePort port(who);
      DeviceOptions options;
      options.port = port.path();
      auto device = kind.create(options);
      ASSERT_TRUE(device) << kind.name;
      testing::Listener listener;
      (*device)->start(listener.sink());
      // Bytes may be a tracker's own, of which a sensor is missing: it names both.
      const bool both = who == test::Stranger::other_baud && kind.name == "nest_of_birds";
      EXPECT_TRUE(listener.says(both ? "its baud rate" : port.quote(), 20))
          << kind.name << " says " << ::testing::PrintToString(listener.lines());
      EXPECT_TRUE(listener.says(port.path() + ": the ")) << kind.name;
      ++tried;
    }
  }
  EXPECT_GE(tried, 10);
}

}  // namespace
}  // namespace prehend::glove
