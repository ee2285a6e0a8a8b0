// A damaged recording: refused with a reason, or read to its end with every failure naming a place.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "common/recording/mcap/reader.hpp"
#include "common/recording/mcap/writer.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;

namespace {

std::string recorded(const std::string& path, recording::mcap::WriterOptions options) {
  {
    auto writer = recording::mcap::Writer::create(path, std::move(options)).value();
    const auto schema = writer.add_schema("a/msg/B", "ros2msg", "uint8 x\n").value();
    const auto channel = writer.add_channel(schema, "t", "cdr", {{"k", "v"}}).value();
    (void)writer.write(
        recording::mcap::Attachment{1, 2, "note", "text/plain", recording::mcap::view("hello")});
    for (std::uint32_t i = 0; i < 30; ++i)
      (void)writer.write(recording::mcap::Message{channel, i, 100 + 7 * i % 50, i,
                                                  recording::mcap::view("0123456789")});
    (void)writer.write(recording::mcap::Metadata{"losses", {{"t", "1"}}});
  }
  return fuzz::read_file(path);
}

bool read(const std::string& path) {
  auto reader = recording::mcap::Reader::open(path);
  fuzz::require(reader || !reader.error().what.empty(), "refused without a reason");
  if (!reader) return false;
  auto cursor = reader->messages();
  std::uint64_t last = 0;
  bool sound = reader->contents().damage.empty();
  while (true) {
    const auto next = cursor.next();
    if (!next) {
      fuzz::require(!next.error().where.empty(), "a failure without a place");
      sound = false;
      continue;
    }
    if (!*next) break;
    // A chunk whose times lie can break the order, which only a damaged file has.
    if ((*next)->message.log_time < last) sound = false;
    last = (*next)->message.log_time;
  }
  recording::mcap::Bytes buffer;
  for (const auto& index : reader->contents().attachments) (void)reader->attachment(index, buffer);
  for (const auto& index : reader->contents().metadata) (void)reader->metadata(index);
  return sound;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("fuzz-" + std::to_string(::getpid()))).string();
  fuzz::Fuzzer fuzzer;
  // Without CRCs damage gets past the first gate, with them it must be seen there.
  for (const auto compression :
       {recording::mcap::Compression::none, recording::mcap::Compression::lz4,
        recording::mcap::Compression::zstd})
    for (const bool crcs : {true, false})
      fuzzer.seeds.push_back(
          recorded(path, {.compression = compression, .chunk_bytes = 300, .crcs = crcs}));
  fuzzer.seeds.push_back(recorded(path, {.chunks = false, .crcs = false}));
  fuzzer.seeds.push_back(recorded(path, {.chunk_bytes = 300, .chunk_index = false, .crcs = false}));
  fuzzer.mutate = [](Random& random, std::string bytes) {
    if (random.index(5) == 0) bytes.resize(random.index(bytes.size()));
    for (std::size_t i = 0, changes = random.index(3); i < changes && !bytes.empty(); ++i)
      bytes = fuzz::mutate_bytes(random, std::move(bytes));
    return bytes;
  };
  fuzzer.target = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
    return read(path);
  };
  const int result = fuzz::run(fuzzer, argc, argv);
  std::filesystem::remove(path);
  return result;
}
