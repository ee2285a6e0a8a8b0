// What is written is what is read, whatever optional parts of the specification a file has: all
// 2^8 settings of the parts, times three compressions. Everything compares exactly.
//
// Crash safety is a property of prefixes: of a file cut anywhere, all messages of every chunk that
// lies wholly in front of the cut are read, and nothing else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "common/base/random.hpp"
#include "common/recording/mcap/reader.hpp"
#include "common/recording/mcap/record_stream.hpp"
#include "common/recording/mcap/survey.hpp"
#include "common/recording/mcap/writer.hpp"
#include "tests/unit/recording/scratch.hpp"

namespace prehend::recording::mcap {
namespace {

using prehend::testing::Scratch;

struct Written {
  std::string topic;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0;
  std::uint64_t publish_time = 0;
  std::string data;
  bool operator==(const Written&) const = default;
};

void PrintTo(const Written& message, std::ostream* out) {
  *out << message.topic << " " << message.sequence << " at " << message.log_time;
}

const std::vector<std::string> topics{"glove/frame", "camera/image", "service/status"};

/// Messages whose log times go back and forth, of very different sizes, some compressible.
std::vector<Written> some_messages(std::size_t count, std::uint64_t seed = 1) {
  Random random(seed);
  std::vector<Written> messages;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint64_t time = 1'000'000'000 + 1000 * i + random.index(5000);
    std::string data(random.index(300), static_cast<char>('a' + random.index(3)));
    if (random.uniform() < 0.3)
      for (char& c : data) c = static_cast<char>(random.bits());
    messages.push_back(
        {topics[random.index(topics.size())], i, time, time - random.index(999), data});
  }
  return messages;
}

WriterOptions small_chunks() {
  WriterOptions options;
  options.chunk_bytes = 2000;
  return options;
}

void write_all(Writer& writer, const std::vector<Written>& messages) {
  const auto schema = writer.add_schema("x/msg/Blob", "ros2msg", "uint8 a\n");
  ASSERT_TRUE(schema);
  std::map<std::string, std::uint16_t> channels;
  for (const std::string& topic : topics)
    channels[topic] = writer.add_channel(*schema, topic, "cdr", {{"z", "1"}, {"a", "2"}}).value();
  for (const Written& message : messages)
    ASSERT_TRUE(writer.write(Message{channels[message.topic], message.sequence, message.log_time,
                                     message.publish_time, view(message.data)}));
}

/// All messages of a file and the failures in between.
std::vector<Written> read_all(Reader& reader, Selection selection = {},
                              std::vector<Error>* failures = nullptr) {
  std::vector<Written> messages;
  MessageCursor cursor = reader.messages(std::move(selection));
  while (true) {
    const auto next = cursor.next();
    if (!next) {
      if (!failures) {
        ADD_FAILURE() << next.error().message();
        break;
      }
      failures->push_back(next.error());
      continue;
    }
    if (!*next) break;
    const auto& [channel, message] = **next;
    messages.push_back({channel->topic, message.sequence, message.log_time, message.publish_time,
                        std::string(text(message.data))});
  }
  return messages;
}

std::vector<Written> in_order(std::vector<Written> messages) {
  std::ranges::stable_sort(messages, {}, &Written::log_time);
  return messages;
}

TEST(McapFile, IsReadAsItWasWrittenWithEveryOptionalPartOnAndOff) {
  const Scratch scratch;
  const std::vector<Written> messages = some_messages(60);
  const std::string blob = "a calibration";
  for (int bits = 0; bits < 512; ++bits) {
    for (const Compression compression : {Compression::none, Compression::lz4, Compression::zstd}) {
      SCOPED_TRACE(bits);
      WriterOptions options = small_chunks();
      options.compression = compression;
      options.chunks = bits & 1;
      options.message_index = bits & 2;
      options.chunk_index = bits & 4;
      options.statistics = bits & 8;
      options.repeated_schemas = bits & 16;
      options.repeated_channels = bits & 16;
      options.attachment_index = bits & 32;
      options.metadata_index = bits & 64;
      options.summary_offsets = bits & 128;
      options.crcs = bits & 256;
      if (!options.chunks && compression != Compression::none) continue;
      const auto path = scratch / "a.mcap";
      {
        Writer writer = Writer::create(path, options).value();
        ASSERT_TRUE(writer.write(Attachment{5, 4, "cal", "text/plain", view(blob)}));
        write_all(writer, messages);
        ASSERT_TRUE(writer.write(Metadata{"run", {{"user", "a"}}}));
        ASSERT_TRUE(writer.close());
      }
      Reader reader = Reader::open(path).value();
      const Contents& contents = reader.contents();
      EXPECT_TRUE(contents.closed);
      EXPECT_TRUE(contents.damage.empty()) << contents.damage.front().message();
      EXPECT_EQ(read_all(reader), in_order(messages));
      EXPECT_EQ(reader.statistics().message_count, messages.size());
      ASSERT_EQ(contents.schemas.size(), 1u);
      EXPECT_EQ(contents.schemas.begin()->second.data, "uint8 a\n");
      EXPECT_EQ(contents.channels.size(), topics.size());
      EXPECT_EQ(contents.channels.begin()->second.metadata, (StringMap{{"z", "1"}, {"a", "2"}}));
      ASSERT_EQ(contents.attachments.size(), 1u);
      Bytes buffer;
      EXPECT_EQ(text(reader.attachment(contents.attachments[0], buffer)->data), blob);
      ASSERT_EQ(contents.metadata.size(), 1u);
      EXPECT_EQ(find(reader.metadata(contents.metadata[0])->metadata, "user"), "a");
    }
  }
}

TEST(McapFile, SelectsByTimeAndTopic) {
  const Scratch scratch;
  const auto messages = some_messages(500);
  for (const bool chunks : {true, false}) {
    WriterOptions options = small_chunks();
    options.chunks = chunks;
    {
      Writer writer = Writer::create(scratch / "a.mcap", options).value();
      write_all(writer, messages);
    }
    Reader reader = Reader::open(scratch / "a.mcap").value();
    Random random(3);
    for (int round = 0; round < 50; ++round) {
      const std::uint64_t start = messages[random.index(messages.size())].log_time;
      const std::uint64_t end = start + random.index(300'000);
      const std::string topic = topics[random.index(topics.size())];
      std::vector<Written> expected;
      std::ranges::copy_if(in_order(messages), std::back_inserter(expected), [&](const Written& m) {
        return m.log_time >= start && m.log_time <= end && m.topic == topic;
      });
      EXPECT_EQ(read_all(reader, {start, end, [&](const Channel& c) { return c.topic == topic; }}),
                expected);
    }
  }
}

/// Messages of the chunks that end at or before a byte, and that byte of each.
std::vector<std::pair<std::uint64_t, std::vector<Written>>> by_chunk(
    const std::filesystem::path& path) {
  std::vector<std::pair<std::uint64_t, std::vector<Written>>> chunks;
  const File file = File::open(path).value();
  RecordStream records(file, magic.size(), file.size());
  std::map<std::uint16_t, std::string> names;
  while (true) {
    const auto raw = records.next();
    if (!raw.value() || (*raw)->opcode == DataEnd::opcode) return chunks;
    if ((*raw)->opcode != Chunk::opcode) continue;
    auto& [end, messages] = chunks.emplace_back((*raw)->end(), std::vector<Written>{});
    const Bytes expanded = expand(parse_as<Chunk>((*raw)->opcode, (*raw)->content).value()).value();
    ChunkRecords inside(expanded);
    while (const auto each = inside.next().value()) {
      const auto record = parse(each->opcode, each->content).value();
      if (const auto* channel = std::get_if<Channel>(&record)) names[channel->id] = channel->topic;
      if (const auto* m = std::get_if<Message>(&record))
        messages.push_back({names[m->channel_id], m->sequence, m->log_time, m->publish_time,
                            std::string(text(m->data))});
    }
  }
}

// Of a chunk that is cut, too, the messages before the cut are read.
TEST(McapFile, AnyPrefixIsReadableUpToItsCut) {
  const Scratch scratch;
  const auto messages = some_messages(200);
  {
    WriterOptions options = small_chunks();
    options.compression = Compression::none;  // the others pack such small chunks in one piece
    Writer writer = Writer::create(scratch / "a.mcap", options).value();
    write_all(writer, messages);
  }
  const auto bytes = prehend::testing::file_bytes(scratch / "a.mcap");
  const auto chunks = by_chunk(scratch / "a.mcap");
  ASSERT_GT(chunks.size(), 5u);
  std::size_t header_end = magic.size() + record_head + 4 + 4 + std::string("prehend").size();
  std::ptrdiff_t salvaged = 0;
  // Every byte around the ends of the chunks, every 13th elsewhere.
  for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
    const bool near_end = std::ranges::any_of(chunks, [&](const auto& chunk) {
      return cut + 12 > chunk.first && cut < chunk.first + 12;
    });
    if (!near_end && cut % 13 != 0) continue;
    SCOPED_TRACE(cut);
    prehend::testing::write_bytes(scratch / "cut.mcap", std::span(bytes).first(cut));
    Expected<Reader> reader = Reader::open(scratch / "cut.mcap");
    ASSERT_EQ(reader.has_value(), cut >= header_end);
    if (!reader) continue;
    EXPECT_FALSE(reader->contents().closed);
    EXPECT_FALSE(reader->contents().remarks.empty());
    std::vector<Written> expected, next;
    for (const auto& [end, inside] : chunks) {
      if (end <= cut) expected.insert(expected.end(), inside.begin(), inside.end());
      if (end > cut && next.empty()) next = inside;
    }
    const auto read = read_all(*reader);
    ASSERT_GE(read.size(), expected.size());
    const auto more = static_cast<std::ptrdiff_t>(read.size() - expected.size());
    ASSERT_LE(more, std::ssize(next));
    expected.insert(expected.end(), next.begin(), next.begin() + more);
    EXPECT_EQ(read, in_order(expected));
    salvaged += more;
    if (more > 0) {
      EXPECT_FALSE(reader->contents().damage.empty()) << "the rest of the chunk is lost";
    }
  }
  EXPECT_GT(salvaged, 0);
}

TEST(McapFile, WithoutChunksAnyPrefixIsReadableUpToItsLastWholeMessage) {
  const Scratch scratch;
  const auto messages = some_messages(40);
  WriterOptions options;
  options.chunks = false;
  {
    Writer writer = Writer::create(scratch / "a.mcap", options).value();
    write_all(writer, messages);
  }
  const auto bytes = prehend::testing::file_bytes(scratch / "a.mcap");
  std::vector<std::uint64_t> ends;
  const File file = File::open(scratch / "a.mcap").value();
  RecordStream records(file, magic.size(), file.size());
  for (auto raw = records.next().value(); raw->opcode != DataEnd::opcode;
       raw = records.next().value())
    if (raw->opcode == Message::opcode) ends.push_back(raw->end());
  for (std::size_t cut = 100; cut < bytes.size(); cut += 7) {
    prehend::testing::write_bytes(scratch / "cut.mcap", std::span(bytes).first(cut));
    Reader reader = Reader::open(scratch / "cut.mcap").value();
    const auto whole = std::ranges::count_if(ends, [&](std::uint64_t end) { return end <= cut; });
    EXPECT_EQ(read_all(reader), in_order({messages.begin(), messages.begin() + whole}));
  }
}

TEST(McapFile, WhatIsNotWhereItsIndexSaysIsTold) {
  const Scratch scratch;
  {
    Writer writer = Writer::create(scratch / "a.mcap").value();
    write_all(writer, some_messages(2));
  }
  const Reader reader = Reader::open(scratch / "a.mcap").value();
  Bytes buffer;
  EXPECT_EQ(reader.attachment({}, buffer).error().what, "there is no attachment here");
  EXPECT_EQ(reader.metadata({}).error().what, "there is no metadata here");
  const File file = File::open(scratch / "a.mcap").value();
  std::filesystem::resize_file(scratch / "a.mcap", 10);
  EXPECT_EQ(file.read(0, 20).error().what, "the file was cut while it was read");
  const ChunkIndex short_place{.chunk_start_offset = 2, .chunk_length = 4};
  EXPECT_EQ(read_chunk(file, short_place).error().what,
            "a chunk does not fill the place that the index gives it");
  const Stretch changed{.begin = 0, .end = 8, .compression = Compression::zstd, .size = 20};
  EXPECT_EQ(read_stretch(file, changed).error().what, "is not as it was");
}

TEST(McapFile, AnIdIsOfOneChannelAndAnyThatIsFreeIsGiven) {
  const Scratch scratch;
  Writer writer = Writer::create(scratch / "a.mcap").value();
  Channel channel;
  channel.id = 65535;
  ASSERT_TRUE(writer.write(channel));
  ASSERT_TRUE(writer.write(channel)) << "the same once more";
  channel.topic = "other";
  EXPECT_EQ(writer.write(channel).error().what, "channel 65535 is something else");
  EXPECT_EQ(writer.add_channel(0, "next", "cdr").value(), 1) << "there is room below the highest";
  ASSERT_TRUE(writer.write(Channel{3, 0, "third", "cdr", {}}));
  EXPECT_EQ(writer.add_channel(0, "second", "cdr").value(), 2);
  EXPECT_EQ(writer.add_channel(0, "fourth", "cdr").value(), 4);
  Writer full = Writer::create(scratch / "full.mcap").value();
  for (int id = 1; id <= 65535; ++id) ASSERT_EQ(full.add_channel(0, "t", "cdr").value(), id);
  EXPECT_EQ(full.add_channel(0, "next", "cdr").error().what, "more than 65535 channels");
}

TEST(McapFile, WhatWasFlushedIsReadableWhileTheWriterGoesOn) {
  const Scratch scratch;
  const auto messages = some_messages(10);
  Writer writer = Writer::create(scratch / "a.mcap").value();
  write_all(writer, messages);
  ASSERT_TRUE(writer.flush());
  Reader reader = Reader::open(scratch / "a.mcap").value();
  EXPECT_FALSE(reader.contents().closed);
  EXPECT_EQ(read_all(reader), in_order(messages));
}

TEST(McapFile, ADamagedChunkIsNamedAndTheOthersAreRead) {
  const Scratch scratch;
  const auto messages = some_messages(200);
  {
    Writer writer = Writer::create(scratch / "a.mcap", small_chunks()).value();
    write_all(writer, messages);
  }
  const auto chunks = by_chunk(scratch / "a.mcap");
  auto bytes = prehend::testing::file_bytes(scratch / "a.mcap");
  bytes[chunks[2].first - 30] ^= 0x10;
  prehend::testing::write_bytes(scratch / "bad.mcap", bytes);
  Reader reader = Reader::open(scratch / "bad.mcap").value();
  std::vector<Error> failures;
  std::vector<Written> expected;
  for (std::size_t i = 0; i < chunks.size(); ++i)
    if (i != 2) expected.insert(expected.end(), chunks[i].second.begin(), chunks[i].second.end());
  EXPECT_EQ(read_all(reader, {}, &failures), in_order(expected));
  ASSERT_EQ(failures.size(), 1u);
  EXPECT_THAT(failures[0].where, ::testing::HasSubstr("bad.mcap at byte "));
}

TEST(McapFile, RefusesWhatIsNoRecording) {
  const Scratch scratch;
  const auto refused = [&](const std::string& content) {
    prehend::testing::write_bytes(scratch / "x.mcap", content);
    const auto reader = Reader::open(scratch / "x.mcap");
    return reader ? std::string("read") : reader.error().what;
  };
  EXPECT_EQ(refused(""), "too short to be an MCAP file");
  EXPECT_EQ(refused("SQLite format 3 and more of it"), "not an MCAP file");
  EXPECT_EQ(refused("\x89MCAP1\r\n and more of it"), "an MCAP file of another major version");
  EXPECT_FALSE(Reader::open(scratch / "not there"));
  EXPECT_FALSE(Reader::open("/tmp"));
}

TEST(McapFile, UnknownRecordsArePassedBy) {
  const Scratch scratch;
  Bytes bytes(magic.begin(), magic.end());
  append_record(bytes, Header{});
  const auto add_unknown = [](Bytes& out) {
    append(out, std::uint8_t{0x77});
    append(out, std::uint64_t{3});
    append(out, view("abc"));
  };
  add_unknown(bytes);
  Bytes inside;
  append_record(inside, Channel{7, 0, "t", "json", {}});
  add_unknown(inside);
  append_record(inside, Message{7, 1, 2, 3, view("{}")});
  append_record(bytes, Chunk{2, 2, inside.size(), 0, "", inside});
  add_unknown(bytes);
  append_record(bytes, DataEnd{});
  append_record(bytes, Footer{});
  append(bytes, View(magic));
  prehend::testing::write_bytes(scratch / "a.mcap", bytes);
  Reader reader = Reader::open(scratch / "a.mcap").value();
  EXPECT_TRUE(reader.contents().damage.empty());
  EXPECT_EQ(read_all(reader), (std::vector<Written>{{"t", 1, 2, 3, "{}"}}));
}

TEST(McapFile, LengthsThatLieCostNoMemory) {
  // A chunk of a few bytes says that it holds 2 GiB.
  const Bytes content{1, 2, 3};
  Bytes compressed;
  ASSERT_TRUE(compress(Compression::zstd, content, compressed));
  for (const Compression compression : {Compression::none, Compression::lz4, Compression::zstd})
    EXPECT_FALSE(decompress(compression, compressed, (std::uint64_t{1} << 31) - 1));
  EXPECT_FALSE(decompress(Compression::zstd, compressed, 2));
  EXPECT_EQ(decompress(Compression::zstd, compressed, 3).value(), content);
  EXPECT_EQ(compress(static_cast<Compression>(9), content, compressed).error().what,
            "compression of no known kind");
}

TEST(McapFile, RefusesMessagesOfUnknownChannelsAndChannelsOfUnknownSchemas) {
  const Scratch scratch;
  Writer writer = Writer::create(scratch / "a.mcap").value();
  EXPECT_FALSE(writer.write(Message{3, 0, 0, 0, {}}));
  EXPECT_FALSE(writer.add_channel(9, "t", "cdr"));
  EXPECT_FALSE(writer.write(Schema{0, "a", "b", "c"}));
  EXPECT_TRUE(writer.write(Schema{4, "a", "b", "c"}));
  EXPECT_TRUE(writer.write(Schema{4, "a", "b", "c"}));
  EXPECT_FALSE(writer.write(Schema{4, "a", "b", "other"}));
}

TEST(McapFile, AFullDiskLeavesAWholeFile) {
  // /dev/full takes nothing.
  const auto writer = Writer::create("/dev/full");
  ASSERT_FALSE(writer);
  EXPECT_THAT(writer.error().what, ::testing::HasSubstr("No space"));
}

}  // namespace
}  // namespace prehend::recording::mcap
