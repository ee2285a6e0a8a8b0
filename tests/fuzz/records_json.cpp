// A damaged document of records, as the MCAP conformance tests have them: refused with a reason, or
// a file that is sound to its last byte and prints as records again.
#include "services/recorder/tools/recording/records_json.hpp"

#include <unistd.h>

#include <filesystem>
#include <sstream>

#include "common/recording/mcap/writer.hpp"
#include "services/recorder/tools/recording/verify.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;

namespace {

std::string document(const std::string& path, const recording::mcap::WriterOptions& options) {
  {
    auto writer = recording::mcap::Writer::create(path, options).value();
    const auto schema = writer.add_schema("a/msg/B", "ros2msg", "uint8 x\n").value();
    const auto channel = writer.add_channel(schema, "t", "cdr", {{"k", "v"}}).value();
    (void)writer.write(
        recording::mcap::Attachment{1, 2, "note", "text/plain", recording::mcap::view("hi")});
    for (std::uint32_t i = 0; i < 3; ++i)
      (void)writer.write(
          recording::mcap::Message{channel, i, 100 + i, i, recording::mcap::view("012")});
    (void)writer.write(recording::mcap::Metadata{"losses", {{"t", "1"}}});
  }
  std::ostringstream text;
  (void)recorder::print_records(path, text);
  return text.str();
}

bool write(const std::string& text, const std::string& path) {
  const auto written = recorder::write_records(text, path);
  fuzz::require(written || !written.error().what.empty(), "refused without a reason");
  if (!written) return false;
  const auto findings = recorder::verify(path);
  fuzz::require(findings.has_value(), "what was written cannot be verified");
  fuzz::require(findings->empty(), findings->empty() ? "" : findings->front().message());
  std::ostringstream again;
  fuzz::require(recorder::print_records(path, again).has_value(), "its records cannot be printed");
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string path =
      (std::filesystem::temp_directory_path() / ("fuzz-" + std::to_string(::getpid()))).string();
  fuzz::Fuzzer fuzzer;
  const std::string plain = document(path, {.compression = recording::mcap::Compression::none});
  fuzzer.seeds.push_back(plain);
  for (const char* features :
       {"\"ch\",\"mx\",\"st\",\"rsh\",\"rch\",\"ax\",\"mdx\",\"chx\",\"sum\"", "\"pad\",\"st\"",
        ""})
    fuzzer.seeds.push_back("{\"meta\":{\"variant\":{\"features\":[" + std::string(features) +
                           "]}}," + plain.substr(1));
  fuzzer.mutate = [](Random& random, std::string text) {
    for (std::size_t i = 0, changes = 1 + random.index(2); i < changes; ++i)
      switch (random.index(6)) {
        case 0:
          text = fuzz::mutate_bytes(random, std::move(text));
          break;
        case 1: {
          const std::size_t at = text.find('"', random.index(text.size() + 1));
          if (at == std::string::npos) break;
          const std::size_t depth = random.index(20) == 0 ? 200'000 : 1;
          text.insert(at, std::string(depth, '['));
          const std::size_t end = text.find('"', at + depth + 1);
          if (end != std::string::npos) text.insert(end + 1, std::string(depth, ']'));
          break;
        }
        case 2:
          text = fuzz::mutate_lines(random, std::move(text));
          break;
        default:
          text = fuzz::mutate_number(random, std::move(text));
      }
    return text;
  };
  fuzzer.target = [&](const std::string& text) { return write(text, path); };
  const int result = fuzz::run(fuzzer, argc, argv);
  std::filesystem::remove(path);
  return result;
}
