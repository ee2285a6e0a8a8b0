#include "common/recording/mcap/reader.hpp"

#include <algorithm>
#include <list>
#include <queue>
#include <set>

#include "common/recording/mcap/measure.hpp"
#include "common/recording/mcap/record_stream.hpp"
#include "common/recording/mcap/survey.hpp"

namespace prehend::recording::mcap {

Reader::Reader(File file)
    : file_(std::make_unique<File>(std::move(file))), contents_(std::make_unique<Contents>()) {}

Expected<Reader> Reader::open(const std::filesystem::path& path) {
  auto file = File::open(path);
  if (!file) return tl::unexpected(file.error());
  Reader reader(std::move(*file));
  auto contents = survey(*reader.file_);
  if (!contents) return tl::unexpected(contents.error());
  *reader.contents_ = std::move(*contents);
  return reader;
}

const Measured& Reader::measured() {
  if (!measured_) measured_ = std::make_unique<Measured>(measure(*file_, *contents_));
  return *measured_;
}

MessageCursor Reader::messages(Selection selection) {
  measured();  // the times of chunks, by which they are chosen and ordered, are right from here on
  return MessageCursor(*file_, *contents_, std::move(selection));
}

Expected<Attachment> Reader::attachment(const AttachmentIndex& index, Bytes& buffer) const {
  auto bytes = file_->read(index.offset, index.length);
  if (!bytes) return tl::unexpected(bytes.error());
  buffer = std::move(*bytes);
  const auto raw = ChunkRecords(buffer).next();
  if (!raw || !*raw) return fail("there is no attachment here", file_->at(index.offset));
  auto attachment = parse_as<Attachment>((*raw)->opcode, (*raw)->content);
  if (!attachment) return at(*file_, index.offset, attachment.error());
  const std::size_t covered =
      attachment->data.data() + attachment->data.size() - (*raw)->content.data();
  if (attachment->crc != 0 && crc32((*raw)->content.first(covered)) != attachment->crc)
    return fail("the attachment's CRC is wrong", file_->at(index.offset));
  return attachment;
}

Expected<Metadata> Reader::metadata(const MetadataIndex& index) const {
  const auto bytes = file_->read(index.offset, index.length);
  if (!bytes) return tl::unexpected(bytes.error());
  const auto raw = ChunkRecords(*bytes).next();
  if (!raw || !*raw) return fail("there is no metadata here", file_->at(index.offset));
  auto metadata = parse_as<Metadata>((*raw)->opcode, (*raw)->content);
  if (!metadata) return at(*file_, index.offset, metadata.error());
  return metadata;
}

struct MessageCursor::State {
  /// A chunk or a stretch, by the earliest time in it.
  struct Source {
    std::uint64_t start = 0;
    std::uint64_t offset = 0;  // in the file
    const ChunkIndex* chunk = nullptr;
    const Stretch* stretch = nullptr;
  };
  /// A source whose records were read.
  struct Loaded {
    std::uint64_t offset = 0;
    Bytes records;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> messages;  // time, place in the records
    std::size_t at = 0;
  };
  using Place = std::list<Loaded>::iterator;

  State(const File& the_file, Contents& the_contents, Selection the_selection)
      : file(the_file), contents(the_contents), selection(std::move(the_selection)) {
    const auto add = [&](std::uint64_t start, std::uint64_t end, Source source) {
      if (start <= selection.end && end >= selection.start) sources.push_back(source);
    };
    for (const ChunkIndex& chunk : contents.chunks)
      add(chunk.message_start_time, chunk.message_end_time,
          {chunk.message_start_time, chunk.chunk_start_offset, &chunk, nullptr});
    for (const Stretch& stretch : contents.stretches)
      add(stretch.message_start_time, stretch.message_end_time,
          {stretch.message_start_time, stretch.begin, nullptr, &stretch});
    std::ranges::sort(sources, {}, [](const Source& s) { return std::pair(s.start, s.offset); });
  }

  bool wanted(const Channel& channel) {
    if (!selection.wanted) return true;
    const auto known = decided.find(channel.id);
    if (known != decided.end()) return known->second;
    return decided[channel.id] = selection.wanted(channel);
  }

  /// Reads a source and lists its messages. On failure those before the bad place are listed.
  Expected<void> load(const Source& source) {
    auto records =
        source.chunk ? read_chunk(file, *source.chunk) : read_stretch(file, *source.stretch);
    if (!records) return tl::unexpected(records.error());
    Loaded fresh{.offset = source.offset, .records = std::move(*records)};
    const auto listed = list_messages(fresh);
    std::ranges::stable_sort(fresh.messages, {}, &std::pair<std::uint64_t, std::uint64_t>::first);
    if (!fresh.messages.empty()) {
      loaded.push_front(std::move(fresh));
      queue.push(loaded.begin());
    }
    if (!listed) return at(file, source.offset, listed.error());
    return {};
  }

  Expected<void> list_messages(Loaded& fresh) {
    Expected<void> result;
    ChunkRecords inside(fresh.records);
    while (true) {
      const auto raw = inside.next();
      if (!raw) return tl::unexpected(raw.error());
      if (!*raw) return result;
      const auto record = parse((*raw)->opcode, (*raw)->content);
      if (!record) return tl::unexpected(record.error());
      if (const auto* schema = std::get_if<Schema>(&*record)) {
        contents.schemas.emplace(schema->id, *schema);
      } else if (const auto* channel = std::get_if<Channel>(&*record)) {
        contents.channels.emplace(channel->id, *channel);
      } else if (const auto* message = std::get_if<Message>(&*record)) {
        const auto channel_of = contents.channels.find(message->channel_id);
        if (channel_of == contents.channels.end()) {
          result = fail("a message belongs to channel " + std::to_string(message->channel_id) +
                        ", which is not in the file");
          continue;
        }
        if (message->log_time >= selection.start && message->log_time <= selection.end &&
            wanted(channel_of->second))
          fresh.messages.emplace_back(message->log_time, (*raw)->offset);
      }
    }
  }

  const File& file;
  Contents& contents;
  Selection selection;
  std::map<std::uint16_t, bool> decided;
  std::vector<Source> sources;
  std::size_t next_source = 0;

  static bool later(const Place& a, const Place& b) {
    const auto time_a = a->messages[a->at].first, time_b = b->messages[b->at].first;
    return std::pair(time_a, a->offset) > std::pair(time_b, b->offset);
  }
  std::list<Loaded> loaded;
  std::priority_queue<Place, std::vector<Place>, decltype(&later)> queue{&later};
  std::optional<Place> current;  // whose message was handed out last
};

MessageCursor::MessageCursor(const File& file, Contents& contents, Selection selection)
    : state_(std::make_unique<State>(file, contents, std::move(selection))) {}
MessageCursor::MessageCursor(MessageCursor&&) noexcept = default;
MessageCursor& MessageCursor::operator=(MessageCursor&&) noexcept = default;
MessageCursor::~MessageCursor() = default;

Expected<std::optional<ReadMessage>> MessageCursor::next() {
  State& s = *state_;
  if (s.current) {
    const State::Place place = *s.current;
    s.current.reset();
    if (++place->at < place->messages.size())
      s.queue.push(place);
    else
      s.loaded.erase(place);
  }
  // A source is read when its first message could be the next one.
  while (s.next_source < s.sources.size()) {
    const State::Source& source = s.sources[s.next_source];
    if (!s.queue.empty()) {
      const State::Place top = s.queue.top();
      if (source.start > top->messages[top->at].first) break;
    }
    ++s.next_source;
    if (auto done = s.load(source); !done) return tl::unexpected(done.error());
  }
  if (s.queue.empty()) return std::nullopt;
  const State::Place place = s.queue.top();
  s.queue.pop();
  s.current = place;
  ChunkRecords one(View(place->records).subspan(place->messages[place->at].second));
  const auto raw = one.next();
  const auto message = parse_as<Message>((*raw)->opcode, (*raw)->content);
  return ReadMessage{&s.contents.channels.at(message->channel_id), *message};
}

}  // namespace prehend::recording::mcap
