// samples FOLDER ENCODING COMPRESSION: writes FOLDER/samples.mcap with random messages of every
// topic type, described in the schema encoding, and FOLDER/expected.json with what they say:
// {"messages": {topic: [value, ...]}}. Whole numbers are strings with an i in front, others with a
// d, texts with an s, so that nothing is lost in a reader's numbers.
#include <fmt/format.h>

#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/recording/mcap/writer.hpp"
#include "common/recording/types/idl.hpp"
#include "common/recording/types/schema_text.hpp"
#include "tests/support/paths/paths.hpp"
#include "tests/unit/recording/random_message.hpp"

using namespace prehend;
using Json = nlohmann::ordered_json;

namespace {

Json exact(const recording::types::Value& value) {
  using recording::types::Value;
  if (const auto* fields = std::get_if<Value::Fields>(&value.content)) {
    Json object = Json::object();
    for (const auto& [name, each] : *fields) object[std::string(name)] = exact(each);
    return object;
  }
  if (const auto* list = std::get_if<Value::List>(&value.content)) {
    Json array = Json::array();
    for (const Value& each : *list) array.push_back(exact(each));
    return array;
  }
  if (const auto* bytes = std::get_if<Value::Bytes>(&value.content)) {
    Json array = Json::array();
    for (const std::uint8_t byte : *bytes) array.push_back(fmt::format("i{}", byte));
    return array;
  }
  if (const auto* truth = std::get_if<bool>(&value.content)) return *truth;
  if (const auto* number = std::get_if<std::int64_t>(&value.content))
    return fmt::format("i{}", *number);
  if (const auto* number = std::get_if<std::uint64_t>(&value.content))
    return fmt::format("i{}", *number);
  if (const auto* number = std::get_if<double>(&value.content)) return fmt::format("d{}", *number);
  if (const auto* enumerator = std::get_if<recording::types::Enumerator>(&value.content))
    return fmt::format("i{}", enumerator->value);
  return "s" + std::get<std::string>(value.content);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const std::string folder = argv[1], encoding = argv[2], compression = argv[3];
  const recording::types::Library contract =
      recording::types::load_idl(test::in_sources("idl")).value();
  recording::mcap::WriterOptions options{
      .compression = recording::mcap::compression_named(compression).value(), .chunk_bytes = 5000};
  recording::mcap::Writer writer =
      recording::mcap::Writer::create(folder + "/samples.mcap", options).value();
  Json messages = Json::object();
  Random random(17);
  std::uint64_t time = 1'700'000'000'000'000'000;
  for (const auto& [name, type] : contract.structures()) {
    if (!type->find("stamp_ns")) continue;  // no topic's
    const bool ros2 = encoding == "ros2msg";
    const auto schema = writer.add_schema(
        ros2 ? recording::types::ros2_name(name) : name, encoding,
        ros2 ? recording::types::ros2msg(*type) : recording::types::omgidl(*type));
    const auto channel = writer.add_channel(schema.value(), name, "cdr", {{"type", name}}).value();
    for (std::uint32_t i = 0; i < 20; ++i) {
      const recording::types::Value value = testing::random_value(*type, random);
      const auto bytes = testing::encode(*type, value, i % 4 == 3);
      if (!writer.write(recording::mcap::Message{channel, i, ++time, time, bytes})) return 1;
      messages[name].push_back(exact(value));
    }
  }
  if (!writer.close()) return 1;
  std::ofstream(folder + "/expected.json") << Json{{"messages", messages}}.dump();
  return 0;
}
