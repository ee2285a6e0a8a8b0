#include "services/recorder/tools/recording/records_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <set>

#include "common/recording/mcap/record_stream.hpp"
#include "common/recording/mcap/writer.hpp"

namespace prehend::recorder {
namespace {

using namespace recording::mcap;
using Json = nlohmann::ordered_json;

// Of a document; ours have 6. Json copies and prints itself as deep on the stack as it is.
constexpr int max_depth = 16;

Json value(std::uint64_t number) {
  return std::to_string(number);
}
Json value(const std::string& text) {
  return text;
}
Json value(View bytes) {
  Json list = Json::array();
  for (const std::uint8_t byte : bytes) list.push_back(std::to_string(byte));
  return list;
}
Json value(const StringMap& map) {
  Json object = Json::object();
  for (const auto& [key, each] : map) object[key] = each;
  return object;
}
Json value(const CountMap& map) {
  Json object = Json::object();
  for (const auto& [key, each] : map) object[std::to_string(key)] = std::to_string(each);
  return object;
}

Json record_json(std::string_view type,
                 std::initializer_list<std::pair<const char*, Json>> fields) {
  Json list = Json::array();
  for (const auto& [name, each] : fields) list.push_back(Json::array({name, each}));
  return {{"type", type}, {"fields", std::move(list)}};
}

struct ToJson {
  Json operator()(const Header& r) const {
    return record_json("Header", {{"library", value(r.library)}, {"profile", value(r.profile)}});
  }
  Json operator()(const Footer& r) const {
    return record_json("Footer", {{"summary_crc", value(r.summary_crc)},
                                  {"summary_offset_start", value(r.summary_offset_start)},
                                  {"summary_start", value(r.summary_start)}});
  }
  Json operator()(const Schema& r) const {
    return record_json("Schema", {{"data", value(view(r.data))},
                                  {"encoding", value(r.encoding)},
                                  {"id", value(r.id)},
                                  {"name", value(r.name)}});
  }
  Json operator()(const Channel& r) const {
    return record_json("Channel", {{"id", value(r.id)},
                                   {"message_encoding", value(r.message_encoding)},
                                   {"metadata", value(r.metadata)},
                                   {"schema_id", value(r.schema_id)},
                                   {"topic", value(r.topic)}});
  }
  Json operator()(const Message& r) const {
    return record_json("Message", {{"channel_id", value(r.channel_id)},
                                   {"data", value(r.data)},
                                   {"log_time", value(r.log_time)},
                                   {"publish_time", value(r.publish_time)},
                                   {"sequence", value(r.sequence)}});
  }
  Json operator()(const ChunkIndex& r) const {
    return record_json("ChunkIndex", {{"chunk_length", value(r.chunk_length)},
                                      {"chunk_start_offset", value(r.chunk_start_offset)},
                                      {"compressed_size", value(r.compressed_size)},
                                      {"compression", value(r.compression)},
                                      {"message_end_time", value(r.message_end_time)},
                                      {"message_index_length", value(r.message_index_length)},
                                      {"message_index_offsets", value(r.message_index_offsets)},
                                      {"message_start_time", value(r.message_start_time)},
                                      {"uncompressed_size", value(r.uncompressed_size)}});
  }
  Json operator()(const Attachment& r) const {
    return record_json("Attachment", {{"create_time", value(r.create_time)},
                                      {"data", value(r.data)},
                                      {"log_time", value(r.log_time)},
                                      {"media_type", value(r.media_type)},
                                      {"name", value(r.name)}});
  }
  Json operator()(const AttachmentIndex& r) const {
    return record_json("AttachmentIndex", {{"create_time", value(r.create_time)},
                                           {"data_size", value(r.data_size)},
                                           {"length", value(r.length)},
                                           {"log_time", value(r.log_time)},
                                           {"media_type", value(r.media_type)},
                                           {"name", value(r.name)},
                                           {"offset", value(r.offset)}});
  }
  Json operator()(const Statistics& r) const {
    return record_json("Statistics", {{"attachment_count", value(r.attachment_count)},
                                      {"channel_count", value(r.channel_count)},
                                      {"channel_message_counts", value(r.channel_message_counts)},
                                      {"chunk_count", value(r.chunk_count)},
                                      {"message_count", value(r.message_count)},
                                      {"message_end_time", value(r.message_end_time)},
                                      {"message_start_time", value(r.message_start_time)},
                                      {"metadata_count", value(r.metadata_count)},
                                      {"schema_count", value(r.schema_count)}});
  }
  Json operator()(const Metadata& r) const {
    return record_json("Metadata", {{"metadata", value(r.metadata)}, {"name", value(r.name)}});
  }
  Json operator()(const MetadataIndex& r) const {
    return record_json(
        "MetadataIndex",
        {{"length", value(r.length)}, {"name", value(r.name)}, {"offset", value(r.offset)}});
  }
  Json operator()(const SummaryOffset& r) const {
    return record_json("SummaryOffset", {{"group_length", value(r.group_length)},
                                         {"group_opcode", value(r.group_opcode)},
                                         {"group_start", value(r.group_start)}});
  }
  Json operator()(const DataEnd& r) const {
    return record_json("DataEnd", {{"data_section_crc", value(r.data_section_crc)}});
  }
  Json operator()(const Chunk&) const { return nullptr; }
  Json operator()(const MessageIndex&) const { return nullptr; }
  Json operator()(const Unknown&) const { return nullptr; }
};

/// Prints records with commas between them.
class Printer {
 public:
  explicit Printer(std::ostream& out) : out_(out) {}

  Expected<void> print(const RawRecord& raw) {
    const auto record = parse(raw.opcode, raw.content);
    if (!record) return tl::unexpected(record.error());
    if (const auto* chunk = std::get_if<Chunk>(&*record)) {
      const auto expanded = expand(*chunk);
      if (!expanded) return tl::unexpected(expanded.error());
      ChunkRecords inside(*expanded);
      while (true) {
        const auto each = inside.next();
        if (!each) return tl::unexpected(each.error());
        if (!*each) return {};
        // A chunk in a chunk is not allowed; nor would its depth have an end.
        if ((*each)->opcode == Chunk::opcode)
          return fail("damaged: a chunk inside a chunk", {}, recording::mcap::damage_hint);
        if (auto done = print(**each); !done) return done;
      }
    }
    const Json json = to_json(*record);
    if (json.is_null()) return {};
    // Strings of a damaged file may be no UTF-8.
    out_ << (first_ ? "\n" : ",\n") << json.dump(-1, ' ', false, Json::error_handler_t::replace);
    first_ = false;
    return {};
  }

 private:
  std::ostream& out_;
  bool first_ = true;
};

/// A record of the document, whose fields are asked for by name. The first thing that is missing or
/// wrong is kept as error.
class FieldSource {
 public:
  FieldSource(const Json& record, std::string where) : where_(std::move(where)) {
    const auto fields = record.find("fields");
    if (fields == record.end() || !fields->is_array()) return;
    for (const Json& field : *fields)
      if (field.is_array() && field.size() == 2 && field[0].is_string())
        fields_[field[0].get<std::string>()] = &field[1];
  }

  template <class Number>
  requires std::is_integral_v<Number>
  void get(const char* name, Number& number) {
    if (const Json* json = field(name)) read_number(*json, name, number);
  }
  void get(const char* name, std::string& text) {
    const Json* json = field(name);
    if (json && json->is_string())
      text = json->get<std::string>();
    else
      wrong(name, "is no string");
  }
  void get(const char* name, Bytes& bytes) {
    const Json* json = field(name);
    if (!json || !json->is_array()) return wrong(name, "is no list of bytes");
    for (const Json& each : *json) read_number(each, name, bytes.emplace_back());
  }
  void get(const char* name, StringMap& map) {
    const Json* json = field(name);
    if (!json || !json->is_object()) return wrong(name, "is no object");
    for (const auto& [key, each] : json->items()) {
      if (!each.is_string()) return wrong(name, "holds more than strings");
      map.emplace_back(key, each.get<std::string>());
    }
  }

  const std::optional<Error>& error() const { return error_; }

 private:
  const Json* field(const char* name) {
    const auto found = fields_.find(name);
    return found == fields_.end() ? nullptr : found->second;
  }
  void wrong(const char* name, const std::string& what) {
    if (!error_) error_ = Error{fmt::format("field {} {}", name, what), where_, ""};
  }
  template <class Number>
  void read_number(const Json& json, const char* name, Number& number) {
    const std::string text = json.is_string() ? json.get<std::string>() : json.dump();
    const char* end = text.data() + text.size();
    const auto [stop, problem] = std::from_chars(text.data(), end, number);
    if (problem != std::errc() || stop != end) wrong(name, "is no number that fits: " + text);
  }

  std::map<std::string, const Json*> fields_;
  std::string where_;
  std::optional<Error> error_;
};

Expected<WriterOptions> options_of(const Json& document, const std::string& where) {
  WriterOptions options{.compression = Compression::none,
                        .chunk_bytes = std::numeric_limits<std::uint64_t>::max(),
                        .chunk_duration = Duration::max()};
  const Json::json_pointer place("/meta/variant/features");
  if (!document.contains(place)) return options;
  const Json& list = document[place];
  std::set<std::string> features;
  if (!list.is_array()) return fail("meta.variant.features is no list", where);
  for (const Json& each : list) {
    if (!each.is_string()) return fail("meta.variant.features holds more than strings", where);
    features.insert(each.get<std::string>());
  }
  const auto take = [&](const char* name) { return features.erase(name) > 0; };
  options.chunks = take("ch");
  options.message_index = take("mx");
  options.statistics = take("st");
  options.repeated_schemas = take("rsh");
  options.repeated_channels = take("rch");
  options.attachment_index = take("ax");
  options.metadata_index = take("mdx");
  options.chunk_index = take("chx");
  options.summary_offsets = take("sum");
  if (take("pad")) options.padding = {0x01, 0xff, 0xff};
  if (!features.empty()) return fail("feature «" + *features.begin() + "» is not known", where);
  return options;
}

std::string type_of(const Json& record) {
  if (!record.is_object()) return {};
  const auto type = record.find("type");
  return type != record.end() && type->is_string() ? type->get<std::string>() : std::string();
}

/// True when it was the end.
Expected<bool> write_record(const Json& json, const std::string& where, Writer& writer) {
  FieldSource fields(json, where);
  const std::string type = type_of(json);
  const auto written = [&](const auto& record) -> Expected<bool> {
    if (fields.error()) return tl::unexpected(*fields.error());
    if (auto done = writer.write(record); !done) return tl::unexpected(done.error());
    return false;
  };
  if (type == "Schema") {
    Schema record;
    Bytes data;
    fields.get("id", record.id);
    fields.get("name", record.name);
    fields.get("encoding", record.encoding);
    fields.get("data", data);
    record.data = text(data);
    return written(record);
  }
  if (type == "Channel") {
    Channel record;
    fields.get("id", record.id);
    fields.get("schema_id", record.schema_id);
    fields.get("topic", record.topic);
    fields.get("message_encoding", record.message_encoding);
    fields.get("metadata", record.metadata);
    return written(record);
  }
  if (type == "Message") {
    Message record;
    Bytes data;
    fields.get("channel_id", record.channel_id);
    fields.get("sequence", record.sequence);
    fields.get("log_time", record.log_time);
    fields.get("publish_time", record.publish_time);
    fields.get("data", data);
    record.data = data;
    return written(record);
  }
  if (type == "Attachment") {
    Attachment record;
    Bytes data;
    fields.get("log_time", record.log_time);
    fields.get("create_time", record.create_time);
    fields.get("name", record.name);
    fields.get("media_type", record.media_type);
    fields.get("data", data);
    record.data = data;
    return written(record);
  }
  if (type == "Metadata") {
    Metadata record;
    fields.get("name", record.name);
    fields.get("metadata", record.metadata);
    return written(record);
  }
  if (type == "DataEnd") return true;
  return fail("a record of type «" + type + "» cannot be written before DataEnd", where);
}

}  // namespace

Json to_json(const Record& record) {
  return std::visit(ToJson(), record);
}

Expected<void> print_records(const std::filesystem::path& path, std::ostream& out) {
  const auto file = File::open(path);
  if (!file) return tl::unexpected(file.error());
  const auto start = file->read(0, std::min<std::uint64_t>(magic.size(), file->size()));
  if (!start) return tl::unexpected(start.error());
  if (!std::ranges::equal(*start, magic)) return fail("not an MCAP file", file->name());
  out << "{\"records\": [";
  Printer printer(out);
  RecordStream records(*file, magic.size(), file->size());
  Expected<void> result;
  while (result) {
    const auto raw = records.next();
    if (!raw || !*raw) {
      result = raw ? fail("the file has no footer", file->at(records.position()),
                          "prehend recording recover makes a whole one of it")
                   : tl::unexpected(raw.error());
      break;
    }
    if (auto done = printer.print(**raw); !done)
      result = fail(done.error().what, file->at((*raw)->offset));
    if ((*raw)->opcode == Footer::opcode) break;
  }
  out << "\n]}\n";
  return result;
}

Expected<void> write_records(std::string_view text, const std::filesystem::path& file) {
  bool too_deep = false;
  const auto shallow = [&](int depth, Json::parse_event_t, Json&) {
    too_deep = too_deep || depth > max_depth;
    return !too_deep;
  };
  const Json document = Json::parse(text, shallow, false);
  if (too_deep) return fail("too many lists inside each other");
  if (document.is_discarded()) return fail("no JSON");
  const auto records = document.find("records");
  if (!document.is_object() || records == document.end() || !records->is_array())
    return fail("no list «records»");
  auto options = options_of(document, "meta");
  if (!options) return tl::unexpected(options.error());
  if (records->empty() || type_of(records->front()) != "Header")
    return fail("the first record is no header", "records[0]");
  FieldSource header(records->front(), "records[0]");
  header.get("profile", options->profile);
  header.get("library", options->library);
  if (header.error()) return tl::unexpected(*header.error());
  auto writer = Writer::create(file, std::move(*options));
  if (!writer) return tl::unexpected(writer.error());
  for (std::size_t i = 1; i < records->size(); ++i) {
    const Json& record = (*records)[i];
    const std::string where = fmt::format("records[{}]", i);
    const auto ended = write_record(record, where, *writer);
    if (!ended) return tl::unexpected(ended.error());
    if (*ended) return writer->close();
  }
  return fail("no DataEnd among the records", {}, "put one behind the last message");
}

}  // namespace prehend::recorder
