#include "common/audit/record.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace prehend::audit {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t max_line = 4096;
constexpr std::size_t max_text = 1024;

/// A text of the object; false: it is there and is none, or is too long.
bool take(const Json& object, const char* key, std::string& to) {
  const auto found = object.find(key);
  if (found == object.end()) return true;
  if (!found->is_string()) return false;
  to = found->get<std::string>();
  return to.size() <= max_text;
}

}  // namespace

std::string to_text(Time time) {
  const auto ms = std::chrono::floor<std::chrono::milliseconds>(time);
  const auto s = std::chrono::floor<std::chrono::seconds>(ms);
  const std::time_t whole = s.time_since_epoch().count();
  std::tm parts{};
  ::gmtime_r(&whole, &parts);
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", parts, (ms - s).count());
}

std::string to_line(const Record& record) {
  Json line{{"time", to_text(record.time)},
            {"stamp_ns", to_ns(record.time)},
            {"hand", record.hand},
            {"event", std::string(event_names.name(record.event))}};
  if (!record.who.empty()) line["who"] = record.who;
  if (!record.what.empty()) line["what"] = record.what;
  if (record.count != 1) line["count"] = record.count;
  return line.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Expected<Record> parse(std::string_view text) {
  if (text.size() > max_line) return fail("line too long");
  const Json line = Json::parse(text, nullptr, false);
  if (!line.is_object()) return fail("is no JSON object");
  const auto stamp = line.find("stamp_ns");
  if (stamp == line.end() || !stamp->is_number_integer()) return fail("needs a number «stamp_ns»");
  Record record;
  record.time = from_ns(stamp->get<std::int64_t>());
  std::string event;
  if (!take(line, "event", event) || !take(line, "hand", record.hand) ||
      !take(line, "who", record.who) || !take(line, "what", record.what))
    return fail("event, hand, who and what must be texts");
  const auto known = event_names.value(event);
  if (!known) return fail("there is no event «" + event + "»");
  record.event = *known;
  if (const auto count = line.find("count"); count != line.end()) {
    if (!count->is_number_unsigned()) return fail("count must be a number");
    record.count = count->get<std::uint64_t>();
  }
  return record;
}

}  // namespace prehend::audit
