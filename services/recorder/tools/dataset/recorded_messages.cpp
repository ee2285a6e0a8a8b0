#include "services/recorder/tools/dataset/recorded_messages.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "common/base/printable.hpp"
#include "common/recording/compare/recorded_topic.hpp"

namespace prehend::recorder::dataset {
namespace {

/// In the year 2223; sums of later times would not be numbers any more.
constexpr std::uint64_t max_log_time = 8'000'000'000'000'000'000;

}  // namespace

void RecordedMessages::read(
    const std::function<bool(const std::string&)>& wanted,
    const std::function<Expected<void>(const std::string&, const recording::types::Value&, Time)>&
        take) {
  auto cursor = reader_.messages({.wanted = [&](const recording::mcap::Channel& channel) {
    const auto topic = recording::recorded_topic(channel, reader_.contents());
    return topic.end.empty() && wanted(topic.name);
  }});
  while (true) {
    const auto next = cursor.next();
    if (!next) {
      damage_.push_back(next.error());
      continue;
    }
    if (!*next) break;
    const auto& [channel, message] = **next;
    const auto topic = recording::recorded_topic(*channel, reader_.contents()).name;
    const Time time = from_ns(static_cast<std::int64_t>(message.log_time));
    const auto value = decoder_.decode(*channel, message.data);
    const auto taken = message.log_time > max_log_time ? fail("its time is in another age")
                       : !value                        ? tl::unexpected(value.error())
                                                       : take(topic, *value, time);
    if (taken) continue;
    Unused& unused = unused_[topic];
    if (unused.count++ == 0) unused.why = taken.error().message();
  }
}

std::vector<Error> RecordedMessages::damage() const {
  std::vector<Error> all = damage_;
  for (const auto& [topic, unused] : unused_)
    all.push_back({fmt::format("{} messages of {} cannot be used", unused.count, printable(topic)),
                   reader_.file().name(), printable(unused.why)});
  return all;
}

Time first_time(recording::mcap::Reader& reader) {
  return from_ns(
      static_cast<std::int64_t>(std::min(reader.statistics().message_start_time, max_log_time)));
}

Expected<recording::mcap::Reader> open_recording(const std::filesystem::path& file) {
  auto reader = recording::mcap::Reader::open(file);
  if (reader) return reader;
  Error error = reader.error();
  error.exit = ::access(file.c_str(), R_OK) == 0 ? exit_no : exit_broken;
  return tl::unexpected(std::move(error));
}

}  // namespace prehend::recorder::dataset
