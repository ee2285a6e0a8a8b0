#include "services/console/service/mailbox.hpp"

#include <gtest/gtest.h>

namespace prehend::console {
namespace {

dds::RawSample sample(std::uint8_t instance, std::uint8_t byte) {
  dds::RawSample made;
  made.instance[0] = instance;
  made.payload = {byte};
  return made;
}

TEST(Mailbox, KeepsTheNewestOfEachInstanceAndAllOfWhatIsQueued) {
  Mailbox mailbox({false, true});
  for (std::uint8_t i = 0; i < 10; ++i) {
    mailbox.put(0, sample(1, i));
    mailbox.put(0, sample(2, i));
    mailbox.put(1, sample(0, i));
  }
  const auto letters = mailbox.take();
  ASSERT_EQ(letters.size(), 12U);
  EXPECT_EQ(letters[0].payload->at(0), 9);
  EXPECT_EQ(letters[1].payload->at(0), 9);
  for (std::uint8_t i = 0; i < 10; ++i) EXPECT_EQ(letters[2U + i].payload->at(0), i);
  EXPECT_TRUE(mailbox.take().empty());
}

TEST(Mailbox, AnEndReplacesWhatItEnds) {
  Mailbox mailbox({false});
  mailbox.put(0, sample(1, 5));
  dds::RawSample end = sample(1, 0);
  end.kind = dds::RawSample::Kind::disposed;
  mailbox.put(0, std::move(end));
  const auto letters = mailbox.take();
  ASSERT_EQ(letters.size(), 1U);
  EXPECT_FALSE(letters[0].payload);
}

TEST(Mailbox, RingsOnceUntilItIsEmptied) {
  int rings = 0;
  Mailbox mailbox({false, true}, [&] { ++rings; });
  for (std::size_t i = 0; i < 10; ++i) mailbox.put(i % 2, sample(1, 0));
  EXPECT_EQ(rings, 1);
  mailbox.take();
  EXPECT_EQ(rings, 1);
  mailbox.put(1, sample(1, 0));
  EXPECT_EQ(rings, 2);
}

TEST(Mailbox, WhoSendsWithoutEndTakesNoMemoryWithoutEnd) {
  Mailbox mailbox({false, true});
  for (unsigned i = 0; i < 10000; ++i) {
    dds::RawSample one = sample(static_cast<std::uint8_t>(i), 0);
    one.instance[1] = static_cast<std::uint8_t>(i >> 8);
    mailbox.put(0, std::move(one));
    mailbox.put(1, sample(0, 0));
  }
  EXPECT_EQ(mailbox.take().size(), 4096U + 4096U);
  EXPECT_EQ(mailbox.lost(), 2 * (10000U - 4096U));
}

}  // namespace
}  // namespace prehend::console
