// What the tools make of whole, cut and damaged recordings. `verify` must see every single flipped
// bit of a file: each byte is covered by a CRC or compared with what it describes.
#include <gtest/gtest.h>

#include "common/base/random.hpp"
#include "common/recording/mcap/writer.hpp"
#include "services/recorder/tools/recording/copy.hpp"
#include "services/recorder/tools/recording/verify.hpp"
#include "tests/unit/recording/scratch.hpp"

namespace prehend::recorder {
namespace {

using prehend::testing::file_bytes;
using prehend::testing::Scratch;
using prehend::testing::write_bytes;
using namespace prehend::recording::mcap;

/// `count` messages from `first` on, every `step` ns, on one topic, with all kinds of records.
void make(const std::filesystem::path& path, std::uint64_t first, std::uint64_t step, int count,
          const std::string& topic) {
  Writer writer = Writer::create(path, {.chunk_bytes = 300}).value();
  ASSERT_TRUE(writer.write(Attachment{1, 2, "scene", "text/plain", view("a table")}));
  const auto schema = writer.add_schema("a/msg/B", "ros2msg", "uint8 x\n").value();
  const auto channel = writer.add_channel(schema, topic, "cdr", {{"writer", "00"}}).value();
  for (int i = 0; i < count; ++i)
    ASSERT_TRUE(writer.write(Message{channel, static_cast<std::uint32_t>(i), first + i * step,
                                     first, view("0123456789")}));
  ASSERT_TRUE(writer.write(Metadata{"losses", {{topic, "2"}}}));
  ASSERT_TRUE(writer.close());
}

std::vector<std::uint64_t> times(Reader& reader) {
  std::vector<std::uint64_t> result;
  auto cursor = reader.messages();
  while (const auto next = cursor.next().value()) result.push_back(next->message.log_time);
  return result;
}

TEST(Verify, SeesEveryFlippedBit) {
  const Scratch scratch;
  make(scratch / "a.mcap", 100, 5, 30, "t");
  ASSERT_TRUE(verify(scratch / "a.mcap")->empty());
  const auto bytes = file_bytes(scratch / "a.mcap");
  Random random(4);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    auto damaged = bytes;
    damaged[i] ^= static_cast<std::uint8_t>(1u << random.index(8));
    write_bytes(scratch / "b.mcap", damaged);
    const auto findings = verify(scratch / "b.mcap");
    EXPECT_TRUE(!findings || !findings->empty()) << "byte " << i << " of " << bytes.size();
  }
}

TEST(Copy, MakesAWholeFileOfEveryPrefix) {
  const Scratch scratch;
  make(scratch / "a.mcap", 100, 5, 60, "t");
  const auto bytes = file_bytes(scratch / "a.mcap");
  for (std::size_t cut = 40; cut < bytes.size(); cut += 17) {
    write_bytes(scratch / "cut.mcap", std::span(bytes).first(cut));
    std::vector<Reader> sources;
    sources.push_back(Reader::open(scratch / "cut.mcap").value());
    const auto before = times(sources[0]);
    const auto result = copy(sources, scratch / "whole.mcap", {});
    ASSERT_TRUE(result) << result.error().message();
    EXPECT_FALSE(result->damage.empty() && result->remarks.empty());
    EXPECT_TRUE(verify(scratch / "whole.mcap")->empty());
    Reader whole = Reader::open(scratch / "whole.mcap").value();
    EXPECT_EQ(times(whole), before);
  }
}

TEST(Copy, MergesInOrderOfTimeAndAddsLosses) {
  const Scratch scratch;
  make(scratch / "a.mcap", 100, 4, 50, "a");
  make(scratch / "b.mcap", 101, 3, 50, "b");
  make(scratch / "c.mcap", 400, 1, 10, "a");
  std::vector<Reader> sources;
  for (const char* name : {"a.mcap", "b.mcap", "c.mcap"})
    sources.push_back(Reader::open(scratch / name).value());
  ASSERT_EQ(copy(sources, scratch / "all.mcap", {})->messages, 110u);
  EXPECT_TRUE(verify(scratch / "all.mcap")->empty());
  Reader all = Reader::open(scratch / "all.mcap").value();
  const auto merged = times(all);
  EXPECT_TRUE(std::ranges::is_sorted(merged));
  // The two recordings of topic a have one channel; schemas are the same throughout.
  EXPECT_EQ(all.contents().channels.size(), 2u);
  EXPECT_EQ(all.contents().schemas.size(), 1u);
  ASSERT_EQ(all.contents().metadata.size(), 1u);
  EXPECT_EQ(all.metadata(all.contents().metadata[0])->metadata,
            (StringMap{{"a", "4"}, {"b", "2"}}));
}

TEST(Copy, CutsByTimeAndNeverReplacesItsSource) {
  const Scratch scratch;
  make(scratch / "a.mcap", 100, 5, 30, "t");
  std::vector<Reader> sources;
  sources.push_back(Reader::open(scratch / "a.mcap").value());
  CopyOptions options;
  options.selection.start = 110;
  options.selection.end = 130;
  ASSERT_TRUE(copy(sources, scratch / "b.mcap", options));
  Reader part = Reader::open(scratch / "b.mcap").value();
  EXPECT_EQ(times(part), (std::vector<std::uint64_t>{110, 115, 120, 125, 130}));
  EXPECT_FALSE(copy(sources, scratch / "a.mcap", options));
}

}  // namespace
}  // namespace prehend::recorder
