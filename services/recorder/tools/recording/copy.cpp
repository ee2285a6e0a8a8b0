#include "services/recorder/tools/recording/copy.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "common/recording/layout/latched_samples.hpp"

namespace prehend::recorder {
namespace {

using namespace recording::mcap;

constexpr std::uint64_t progress_every = 1000;  // messages

/// Gives schemas and channels of all sources ids of the new file.
class Numbering {
 public:
  explicit Numbering(Writer& writer) : writer_(writer) {}

  Expected<std::uint16_t> channel(std::size_t source, const Channel& channel,
                                  const Contents& contents) {
    const auto known = numbered_.find({source, channel.id});
    if (known != numbered_.end()) return known->second;
    std::uint16_t schema_id = 0;
    if (const auto found = contents.schemas.find(channel.schema_id);
        found != contents.schemas.end()) {
      const auto added = schema(found->second);
      if (!added) return added;
      schema_id = *added;
    }
    const auto key =
        std::tuple(schema_id, channel.topic, channel.message_encoding, channel.metadata);
    auto same = channels_.find(key);
    if (same == channels_.end()) {
      const auto added =
          writer_.add_channel(schema_id, channel.topic, channel.message_encoding, channel.metadata);
      if (!added) return added;
      same = channels_.emplace(key, *added).first;
    }
    return numbered_[{source, channel.id}] = same->second;
  }

 private:
  Expected<std::uint16_t> schema(const Schema& schema) {
    const auto key = std::tuple(schema.name, schema.encoding, schema.data);
    if (const auto same = schemas_.find(key); same != schemas_.end()) return same->second;
    const auto added = writer_.add_schema(schema.name, schema.encoding, schema.data);
    if (added) schemas_[key] = *added;
    return added;
  }

  Writer& writer_;
  std::map<std::pair<std::size_t, std::uint16_t>, std::uint16_t> numbered_;
  std::map<std::tuple<std::string, std::string, std::string>, std::uint16_t> schemas_;
  std::map<std::tuple<std::uint16_t, std::string, std::string, StringMap>, std::uint16_t> channels_;
};

/// Of the losses of a recording the last record counts: totals by topic.
void add_losses(const StringMap& last, std::map<std::string, std::uint64_t>& sums) {
  for (const auto& [topic, text] : last) {
    std::uint64_t count = 0;
    std::from_chars(text.data(), text.data() + text.size(), count);
    sums[topic] += count;
  }
}

Expected<void> copy_side_records(std::vector<Reader>& sources, Writer& writer, CopyResult& result) {
  std::map<std::string, std::uint64_t> losses;
  std::set<std::pair<std::string, StringMap>> written;
  for (Reader& source : sources) {
    for (const AttachmentIndex& index : source.contents().attachments) {
      Bytes buffer;
      const auto attachment = source.attachment(index, buffer);
      if (!attachment) {
        result.damage.push_back(attachment.error());
        continue;
      }
      if (auto done = writer.write(*attachment); !done) return done;
    }
    StringMap last_losses;
    for (const MetadataIndex& index : source.contents().metadata) {
      const auto metadata = source.metadata(index);
      if (!metadata) {
        result.damage.push_back(metadata.error());
      } else if (metadata->name == "losses") {
        last_losses = metadata->metadata;
      } else if (written.emplace(metadata->name, metadata->metadata).second) {
        if (auto done = writer.write(*metadata); !done) return done;
      }
    }
    add_losses(last_losses, losses);
  }
  if (losses.empty()) return {};
  Metadata sum{"losses", {}};
  for (const auto& [topic, count] : losses) sum.metadata.emplace_back(topic, std::to_string(count));
  return writer.write(sum);
}

/// What of one source stands when the part begins, under the ids of the new file.
Expected<void> copy_standing(Reader& source, std::size_t index, Numbering& numbering,
                             Writer& writer, const CopyOptions& options, CopyResult& result) {
  const Contents& contents = source.contents();
  std::map<std::uint16_t, recording::Stream> streams;
  for (const auto& [id, channel] : contents.channels) {
    if (options.selection.wanted && !options.selection.wanted(channel)) continue;
    const auto schema = contents.schemas.find(channel.schema_id);
    auto stream =
        recording::to_stream(channel, schema == contents.schemas.end() ? "" : schema->second.name);
    if (stream && stream->topic.qos.transient_local) streams.emplace(id, std::move(*stream));
  }
  recording::LatchedSamples standing;
  auto cursor =
      source.messages({.end = options.selection.start - 1, .wanted = [&](const Channel& channel) {
                         return streams.contains(channel.id);
                       }});
  while (true) {
    const auto next = cursor.next();
    if (!next) {
      result.damage.push_back(next.error());
      continue;
    }
    if (!*next) break;
    const auto& [channel, message] = **next;
    standing.take(streams.at(channel->id), message);
  }
  for (const auto& sample : standing.samples()) {
    Message message = sample.message();
    const auto id = numbering.channel(index, contents.channels.at(message.channel_id), contents);
    if (!id) return tl::unexpected(id.error());
    message.channel_id = *id;
    message.log_time = options.selection.start;
    if (auto done = writer.write(message); !done) return done;
    ++result.messages;
  }
  return {};
}

Expected<void> copy_messages(std::vector<Reader>& sources, Writer& writer,
                             const CopyOptions& options, CopyResult& result) {
  std::uint64_t total = 0;
  std::vector<MessageCursor> cursors;
  std::vector<std::optional<ReadMessage>> heads(sources.size());
  const auto advance = [&](std::size_t i) {
    while (true) {
      auto next = cursors[i].next();
      if (next) {
        heads[i] = *next;
        return;
      }
      result.damage.push_back(next.error());
    }
  };
  for (std::size_t i = 0; i < sources.size(); ++i) {
    total += sources[i].statistics().message_count;
    cursors.push_back(sources[i].messages(options.selection));
    advance(i);
  }
  Numbering numbering(writer);
  for (std::size_t i = 0; i < sources.size() && options.selection.start > 0; ++i)
    if (auto done = copy_standing(sources[i], i, numbering, writer, options, result); !done)
      return done;
  while (true) {
    std::optional<std::size_t> first;
    for (std::size_t i = 0; i < heads.size(); ++i)
      if (heads[i] && (!first || heads[i]->message.log_time < heads[*first]->message.log_time))
        first = i;
    if (!first) return {};
    Message message = heads[*first]->message;
    const auto id = numbering.channel(*first, *heads[*first]->channel, sources[*first].contents());
    if (!id) return tl::unexpected(id.error());
    message.channel_id = *id;
    if (auto done = writer.write(message); !done) return done;
    if (++result.messages % progress_every == 0 && options.progress && total > 0)
      options.progress(
          std::min(1.0, static_cast<double>(result.messages) / static_cast<double>(total)));
    advance(*first);
  }
}

}  // namespace

Expected<CopyResult> copy(std::vector<Reader>& sources, const std::filesystem::path& to,
                          const CopyOptions& options) {
  CopyResult result;
  for (Reader& source : sources) {
    std::error_code none;
    if (std::filesystem::equivalent(source.file().name(), to, none))
      return fail("would replace what it is made from", to.string(), "choose another name");
    result.damage.insert(result.damage.end(), source.contents().damage.begin(),
                         source.contents().damage.end());
    for (const auto* remarks : {&source.contents().remarks, &source.measured().remarks})
      result.remarks.insert(result.remarks.end(), remarks->begin(), remarks->end());
  }
  const std::filesystem::path unfinished = to.string() + ".part";
  const auto write = [&]() -> Expected<void> {
    auto writer = Writer::create(unfinished, options.writer);
    if (!writer) return tl::unexpected(writer.error());
    if (auto done = copy_side_records(sources, *writer, result); !done) return done;
    if (auto done = copy_messages(sources, *writer, options, result); !done) return done;
    return writer->close();
  };
  std::error_code problem;
  if (auto done = write(); !done) {
    std::filesystem::remove(unfinished, problem);
    return tl::unexpected(done.error());
  }
  std::filesystem::rename(unfinished, to, problem);
  if (problem) return fail(problem.message(), to.string());
  return result;
}

}  // namespace prehend::recorder
