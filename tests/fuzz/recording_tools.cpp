// A damaged recording, as `prehend recording` meets it: opened, verified, described, recovered, cut
// and decoded. None of them may crash, what is refused has a reason, and what recover or cut made
// is sound to its last byte. The seeds are our own recordings with all that a lab writes into them.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/recording/compare/comparison.hpp"
#include "common/recording/compare/recorded_topic.hpp"
#include "common/recording/layout/layout.hpp"
#include "common/recording/mcap/writer.hpp"
#include "common/recording/types/schema_text.hpp"
#include "services/recorder/tools/recording/copy.hpp"
#include "services/recorder/tools/recording/records_json.hpp"
#include "services/recorder/tools/recording/summary.hpp"
#include "services/recorder/tools/recording/verify.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/fuzz/type_texts.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/recording/random_message.hpp"

using namespace prehend;

namespace {

/// Three topics with several instances, ends, losses, IDL and scene.
std::string record(const recording::types::Library& contract, const std::string& path,
                   recording::mcap::WriterOptions options) {
  {
    Random random(1);
    auto writer = recording::mcap::Writer::create(path, std::move(options)).value();
    (void)writer.write(recording::mcap::Attachment{1, 2, "scene.toml", "text/plain",
                                                   recording::mcap::view("a = 1\n")});
    recording::mcap::Metadata idl{"idl", {}};
    std::uint64_t time = 1'000'000'000;
    for (const auto& [topic, name] : {std::pair("object/detection", "prehend::v1::ObjectDetection"),
                                      std::pair("robot/command", "prehend::v2::HandCommand"),
                                      std::pair("lab/clock", "prehend::v2::LabClock")}) {
      const recording::types::Structure& type = *contract.find(name);
      idl.metadata.emplace_back(name, recording::types::omgidl(type));
      const auto schema = writer
                              .add_schema(recording::types::ros2_name(name), "ros2msg",
                                          recording::types::ros2msg(type))
                              .value();
      recording::Stream stream{
          {topic, name, true, prehend::dds::find_topic(topic)->qos}, {1}, {}, "lab"};
      for (std::uint8_t instance = 1; instance < 4; ++instance) {
        stream.instance[15] = instance;
        stream.kind = prehend::dds::RawSample::Kind::data;
        const auto data = recording::to_channel(stream);
        const auto channel =
            writer.add_channel(schema, data.topic, data.message_encoding, data.metadata).value();
        for (std::uint32_t i = 0; i < 4; ++i) {
          const auto bytes = testing::encode(type, testing::random_value(type, random));
          (void)writer.write(recording::mcap::Message{channel, i, time += 1'000'000, time, bytes});
        }
        stream.kind = prehend::dds::RawSample::Kind::disposed;
        const auto end = recording::to_channel(stream);
        const auto ends =
            writer.add_channel(0, end.topic, end.message_encoding, end.metadata).value();
        if (instance == 2)
          (void)writer.write(recording::mcap::Message{ends, 5, time += 1'000'000, time, {}});
      }
    }
    (void)writer.write(idl);
    (void)writer.write(recording::mcap::Metadata{"losses", {{"lab/clock", "1"}}});
  }
  return fuzz::read_file(path);
}

void require_sound(const std::string& path) {
  const auto findings = recorder::verify(path);
  fuzz::require(findings.has_value(), "a file of our own cannot be verified");
  fuzz::require(findings->empty(), findings->empty() ? "" : findings->front().message());
}

/// Everything that `diff` and `export` do with the messages.
void compare(recording::mcap::Reader& reader, const recording::ToleranceTable& tolerances) {
  recording::RecordedTypes types(reader);  // outlives the comparison
  recording::Comparison comparison(tolerances);
  for (const auto side : {recording::Side::expected, recording::Side::actual}) {
    auto cursor = reader.messages();
    while (true) {
      const auto next = cursor.next();
      if (!next) continue;
      if (!*next) break;
      const auto& [channel, message] = **next;
      const auto topic = recording::recorded_topic(*channel, reader.contents());
      const recording::types::Structure* type = types.of(*channel);
      if (type)
        if (const auto value = recording::types::decode(*type, message.data))
          (void)recording::types::to_json(*value);
      comparison.add(side, {topic.name, type, message.data, topic.end});
    }
  }
  const auto report = comparison.finish();
  for (const auto& topic : report.topics)
    for (const auto& each : topic.first) (void)each.text();
  fuzz::require(report.same(), "a recording differs from itself");
}

bool use(const std::string& path, const recording::ToleranceTable& tolerances) {
  const auto findings = recorder::verify(path);
  fuzz::require(findings || !findings.error().what.empty(), "refused without a reason");
  std::ostringstream records;
  (void)recorder::print_records(path, records);
  auto reader = recording::mcap::Reader::open(path);
  fuzz::require(reader.has_value() == findings.has_value(), "opened or not, but not for all");
  if (!reader) return false;
  fuzz::require(recorder::summary(*reader).is_object(), "not described");
  compare(*reader, tolerances);
  std::vector<recording::mcap::Reader> sources;
  sources.push_back(std::move(*reader));
  for (const std::uint64_t start : {0ull, 1'010'000'000ull}) {
    recorder::CopyOptions options;
    options.selection.start = start;
    const auto copied = recorder::copy(sources, path + ".whole", options);
    fuzz::require(copied || !copied.error().what.empty(), "not recovered, without a reason");
    if (copied) require_sound(path + ".whole");
  }
  return findings->empty();
}

}  // namespace

int main(int argc, char** argv) {
  // In memory where that can be had: each try writes three files.
  const bool memory = ::access("/dev/shm", W_OK) == 0;
  const std::string path =
      ((memory ? std::filesystem::path("/dev/shm") : std::filesystem::temp_directory_path()) /
       ("fuzz-" + std::to_string(::getpid())))
          .string();
  const recording::types::Library contract = fuzz::contract();
  const auto tolerances =
      recording::ToleranceTable::load(test::in_sources("common/recording/compare/tolerances.toml"))
          .value();
  fuzz::Fuzzer fuzzer;
  // Without CRCs damage gets past the first gate, with them it must be seen there.
  for (const bool crcs : {true, false}) {
    fuzzer.seeds.push_back(record(contract, path, {.chunk_bytes = 1500, .crcs = crcs}));
    fuzzer.seeds.push_back(record(
        contract, path,
        {.compression = recording::mcap::Compression::none, .chunk_bytes = 1500, .crcs = crcs}));
  }
  fuzzer.seeds.push_back(record(contract, path, {.chunks = false, .crcs = false}));
  fuzzer.long_round = 10'000;
  fuzzer.mutate = [](Random& random, std::string bytes) {
    switch (random.index(20)) {
      case 0:
        return std::string();
      case 1:
        bytes[random.index(8)] = static_cast<char>(random.bits());  // foreign, or of the future
        return bytes;
      case 2:
      case 3:
        bytes.resize(random.index(bytes.size()));  // cut short, and damaged
        break;
      case 4:
        return bytes;
      default:
        break;
    }
    return bytes.empty() ? bytes : fuzz::mutate_bytes(random, std::move(bytes));
  };
  fuzzer.target = [&](const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
    return use(path, tolerances);
  };
  const int result = fuzz::run(fuzzer, argc, argv);
  for (const char* suffix : {"", ".whole", ".whole.part"}) std::filesystem::remove(path + suffix);
  return result;
}
