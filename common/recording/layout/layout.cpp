#include "common/recording/layout/layout.hpp"

#include <fmt/format.h>

#include <charconv>
#include <sstream>

namespace prehend::recording {
namespace {

using Kind = dds::RawSample::Kind;

std::string_view name_of(Kind kind) {
  return kind == Kind::disposed ? "disposed" : kind == Kind::unregistered ? "unregistered" : "data";
}

Expected<dds::Guid> guid_of(std::string_view text) {
  dds::Guid guid{};
  if (text.empty()) return guid;
  if (text.size() != 2 * guid.size()) return fail("is no GUID", std::string(text));
  for (std::size_t i = 0; i < guid.size(); ++i) {
    const char* from = text.data() + 2 * i;
    if (std::from_chars(from, from + 2, guid[i], 16).ptr != from + 2)
      return fail("is no GUID", std::string(text));
  }
  return guid;
}

}  // namespace

std::string to_hex(const dds::Guid& guid) {
  std::string text;
  for (const std::uint8_t byte : guid) text += fmt::format("{:02x}", byte);
  return text;
}

std::string to_text(const dds::TopicQos& qos) {
  std::string text = qos.reliable ? "reliable" : "best_effort";
  text += qos.transient_local ? " transient_local" : " volatile";
  text += qos.writer_depth == 0 ? " keep_all" : fmt::format(" keep_last={}", qos.writer_depth);
  if (qos.deadline.count() > 0) text += fmt::format(" deadline_ms={}", qos.deadline.count());
  if (qos.lifespan.count() > 0) text += fmt::format(" lifespan_ms={}", qos.lifespan.count());
  if (qos.exclusive_ownership) text += " exclusive";
  return text;
}

Expected<dds::TopicQos> qos_of(std::string_view text, const dds::TopicQos& otherwise) {
  dds::TopicQos qos = otherwise;
  std::istringstream words{std::string(text)};
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    std::uint32_t number = 0;
    if (equals != std::string::npos) {
      const char* end = word.data() + word.size();
      const auto [stop, code] = std::from_chars(word.data() + equals + 1, end, number);
      if (stop != end || code != std::errc() || number > 1'000'000'000)
        return fail("is no number", "qos " + word);
    }
    if (name == "reliable" || name == "best_effort")
      qos.reliable = name == "reliable";
    else if (name == "transient_local" || name == "volatile")
      qos.transient_local = name == "transient_local";
    else if (name == "keep_all")
      qos.writer_depth = 0;
    else if (name == "keep_last")
      qos.writer_depth = static_cast<int>(number);
    else if (name == "deadline_ms")
      qos.deadline = std::chrono::milliseconds(number);
    else if (name == "lifespan_ms")
      qos.lifespan = std::chrono::milliseconds(number);
    else if (name == "exclusive" || name == "shared")
      qos.exclusive_ownership = name == "exclusive";
    else
      return fail("is not known", "qos " + word, "was it recorded by a later version?");
  }
  return qos;
}

recording::mcap::Channel to_channel(const Stream& stream) {
  recording::mcap::Channel channel;
  channel.topic = stream.topic.name;
  channel.message_encoding = cdr_encoding;
  channel.metadata = {{"type", stream.topic.type},
                      {"keyed", stream.topic.keyed ? "true" : "false"},
                      {"qos", to_text(stream.topic.qos)},
                      {"rig", stream.rig},
                      {"writer", to_hex(stream.writer)}};
  if (stream.topic.keyed) channel.metadata.emplace_back("instance", to_hex(stream.instance));
  if (stream.kind != Kind::data) {
    channel.topic += "/" + std::string(name_of(stream.kind));
    channel.message_encoding = end_encoding;
    channel.metadata.emplace_back("of", stream.topic.name);
    channel.metadata.emplace_back("change", name_of(stream.kind));
  }
  return channel;
}

Expected<Stream> to_stream(const recording::mcap::Channel& channel, std::string_view schema) {
  const auto value = [&](std::string_view key) {
    return recording::mcap::find(channel.metadata, key);
  };
  const auto wrong = [&](const Error& error) {
    return fail(error.what, "channel " + channel.topic + ": " + error.where, error.hint);
  };
  Stream stream;
  const std::string_view change = value("change");
  if (!change.empty()) {
    if (change != name_of(Kind::disposed) && change != name_of(Kind::unregistered))
      return wrong({"is not known", "change " + std::string(change), ""});
    stream.kind = change == name_of(Kind::disposed) ? Kind::disposed : Kind::unregistered;
  } else if (channel.message_encoding != cdr_encoding) {
    return wrong({"messages are not CDR", "encoding " + channel.message_encoding, ""});
  }
  stream.topic.name = stream.kind == Kind::data ? channel.topic : std::string(value("of"));
  stream.topic.type = value("type").empty() ? schema : value("type");
  const dds::TopicInfo* known = dds::find_topic(stream.topic.name);
  if (value("qos").empty()) {
    stream.topic.qos = known ? known->qos : dds::TopicQos{.writer_depth = 64};
    stream.topic.keyed = false;
  } else {
    auto qos = qos_of(value("qos"));
    if (!qos) return wrong(qos.error());
    stream.topic.qos = *qos;
    stream.topic.keyed = value("keyed") == "true";
  }
  auto writer = guid_of(value("writer")), instance = guid_of(value("instance"));
  if (!writer) return wrong(writer.error());
  if (!instance) return wrong(instance.error());
  stream.writer = *writer;
  stream.instance = *instance;
  stream.rig = value("rig");
  return stream;
}

}  // namespace prehend::recording
