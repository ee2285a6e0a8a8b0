#include "common/recording/mcap/measure.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <tuple>

#include "common/recording/mcap/record_stream.hpp"
#include "common/recording/mcap/survey.hpp"

namespace prehend::recording::mcap {
namespace {

using Times = std::pair<std::uint64_t, std::uint64_t>;

class Measure {
 public:
  Measure(const File& file, Contents& contents) : file_(file), contents_(contents) {}

  Measured run() {
    std::size_t wrong_times = 0;
    for (ChunkIndex& chunk : contents_.chunks) {
      const auto records = read_chunk(file_, chunk);
      if (!records) {
        made_.damage.push_back(records.error());
        continue;
      }
      // Without messages it keeps its times: nothing is chosen by them.
      const auto times = count(*records, chunk.chunk_start_offset);
      if (!times) continue;
      if (*times != Times(chunk.message_start_time, chunk.message_end_time)) ++wrong_times;
      std::tie(chunk.message_start_time, chunk.message_end_time) = *times;
    }
    for (const Stretch& stretch : contents_.stretches)
      if (const auto records = read_stretch(file_, stretch)) count(*records, stretch.begin);
    if (wrong_times > 0)
      remark("the index has other times than the messages of " + std::to_string(wrong_times) +
             (wrong_times == 1 ? " chunk" : " chunks"));
    finish();
    return std::move(made_);
  }

 private:
  /// Takes the messages into the counts; their earliest and latest time.
  std::optional<Times> count(View records, std::uint64_t offset) {
    std::optional<Times> times;
    ChunkRecords inside(records);
    while (true) {
      const auto raw = inside.next();
      if (!raw) {
        made_.damage.push_back(at(file_, offset, raw.error()).value());
        return times;
      }
      if (!*raw) return times;
      const auto record = parse((*raw)->opcode, (*raw)->content);
      if (!record) {
        made_.damage.push_back(at(file_, offset, record.error()).value());
        return times;
      }
      if (const auto* schema = std::get_if<Schema>(&*record)) {
        contents_.schemas.emplace(schema->id, *schema);
      } else if (const auto* channel = std::get_if<Channel>(&*record)) {
        contents_.channels.emplace(channel->id, *channel);
      } else if (const auto* message = std::get_if<Message>(&*record)) {
        const std::uint64_t time = message->log_time;
        made_.statistics.count(message->channel_id, time);
        times = times ? Times(std::min(times->first, time), std::max(times->second, time))
                      : Times(time, time);
      }
    }
  }

  /// Counts beside those of messages, and what is to be said of all.
  void finish() {
    Statistics& counted = made_.statistics;
    counted.schema_count = static_cast<std::uint16_t>(contents_.schemas.size());
    counted.channel_count = static_cast<std::uint32_t>(contents_.channels.size());
    counted.attachment_count = static_cast<std::uint32_t>(contents_.attachments.size());
    counted.metadata_count = static_cast<std::uint32_t>(contents_.metadata.size());
    counted.chunk_count = static_cast<std::uint32_t>(contents_.chunks.size());
    const auto& said = contents_.statistics;
    const bool lies =
        said && made_.damage.empty() && contents_.damage.empty() &&
        (said->message_count != counted.message_count ||
         (counted.message_count > 0 && (said->message_start_time != counted.message_start_time ||
                                        said->message_end_time != counted.message_end_time)));
    if (lies)
      remark("its statistics are wrong: they tell of " + std::to_string(said->message_count) +
             " messages from " + std::to_string(said->message_start_time) + " to " +
             std::to_string(said->message_end_time) + " ns, there are " +
             std::to_string(counted.message_count) + " from " +
             std::to_string(counted.message_start_time) + " to " +
             std::to_string(counted.message_end_time));
    remark_unit();
  }

  /// Times that can hardly be nanoseconds since 1970: those of today in another unit, more than ten
  /// a millisecond, which a recording that really begins so early has not.
  void remark_unit() {
    const Statistics& counted = made_.statistics;
    if (counted.message_count == 0) return;
    const std::uint64_t start = counted.message_start_time;
    constexpr std::uint64_t year_2000 = 946'684'800, year_2100 = 4'102'444'800;  // s
    const bool dense =
        (counted.message_end_time - start) / counted.message_count < 100'000;  // ns a message
    const auto is_now_in = [&](std::uint64_t per_second) {
      return start >= year_2000 * per_second && start <= year_2100 * per_second;
    };
    const char* unit = is_now_in(1)           ? "seconds"
                       : is_now_in(1'000)     ? "milliseconds"
                       : is_now_in(1'000'000) ? "microseconds"
                                              : nullptr;
    if (unit && dense)
      remark(std::string("its log times look like ") + unit + " where MCAP has nanoseconds",
             "a recorder that multiplies them is needed; until then it plays in no time");
    if (start > std::uint64_t{1} << 63)
      remark("its log times lie behind the year 2262", "is the recorder's clock right?");
  }

  void remark(std::string what, std::string hint = "what is said here is counted from the data") {
    made_.remarks.push_back({std::move(what), file_.name(), std::move(hint)});
  }

  const File& file_;
  Contents& contents_;
  Measured made_;
};

}  // namespace

Measured measure(const File& file, Contents& contents) {
  return Measure(file, contents).run();
}

}  // namespace prehend::recording::mcap
