// Damaged messages of other stacks, with damaged descriptions: refused with a reason, or values.
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/recording/mcap/reader.hpp"
#include "common/recording/mcap/writer.hpp"
#include "common/recording/messages/message_decoder.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"
#include "tests/support/foreign/foreign.hpp"

using namespace prehend;

namespace {

constexpr std::string_view between = "\x1f#part#\x1f";

/// Encoding, schema and message, one behind the other.
std::string packed(test::Stack stack, const test::Schema& schema,
                   const std::vector<std::uint8_t>& message) {
  std::string text = test::encoding_of(stack);
  for (const std::string& part :
       {schema.encoding, schema.name, schema.data, std::string(message.begin(), message.end())})
    text += std::string(between) + part;
  return text;
}

std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(between, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + between.size();
  }
  parts.resize(5);
  return parts;
}

bool decode(const std::filesystem::path& path, const std::string& text) {
  using namespace recording::mcap;
  const auto parts = parts_of(text);
  {
    auto writer = Writer::create(path, {.compression = Compression::none}).value();
    const auto schema = writer.add_schema(parts[2], parts[1], parts[3]).value();
    const auto channel = writer.add_channel(schema, "/x", parts[0]).value();
    const std::vector<std::uint8_t> data(parts[4].begin(), parts[4].end());
    fuzz::require(writer.write(Message{channel, 1, 1, 1, data}).has_value(), "not written");
    fuzz::require(writer.close().has_value(), "not closed");
  }
  auto reader = Reader::open(path);
  if (!reader) return false;
  recording::MessageDecoder decoder(*reader);
  auto cursor = reader->messages();
  const auto next = cursor.next();
  if (!next || !*next) return false;
  const auto value = decoder.decode(*(*next)->channel, (*next)->message.data);
  if (!value) {
    fuzz::require(!value.error().what.empty(), "refused without a reason");
    return false;
  }
  (void)recording::types::to_json(*value).dump(-1, ' ', false,
                                               nlohmann::json::error_handler_t::replace);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  for (const test::Stack stack : test::all_stacks) {
    fuzzer.seeds.push_back(packed(stack, test::joints_schema(stack),
                                  test::message(stack, test::Joints{{"a", "b"}, {1, 2}, {3, 4}})));
    fuzzer.seeds.push_back(
        packed(stack, test::place_schema(stack), test::message(stack, test::Place{})));
    fuzzer.seeds.push_back(
        packed(stack, test::picture_schema(stack), test::picture_message(stack, "picture")));
    fuzzer.seeds.push_back(packed(stack, test::raster_schema(stack),
                                  test::message(stack, test::Raster{2, 1, "blured"})));
  }
  const auto path = std::filesystem::temp_directory_path() /
                    ("fuzz-foreign-" + std::to_string(::getpid()) + ".mcap");
  fuzzer.mutate = fuzz::mutate_bytes;
  fuzzer.target = [&](const std::string& text) { return decode(path, text); };
  const int code = fuzz::run(fuzzer, argc, argv);
  std::filesystem::remove(path);
  return code;
}
