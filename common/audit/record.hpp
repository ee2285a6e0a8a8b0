#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/named_values.hpp"
#include "common/base/time.hpp"

namespace prehend::audit {

enum class Event {
  begin,
  end,
  lead,
  lead_end,
  stop,
  release,
  takeover,
  order_refused,
  consent,
  consent_end,
  refused
};
inline constexpr auto event_names = named_values<Event>(
    {{Event::begin, "begin", "the gate was made"},
     {Event::end, "end", "the service ended"},
     {Event::lead, "lead", "who began to lead"},
     {Event::lead_end, "lead_end", "who leads no more"},
     {Event::stop, "stop", "who stopped the hand, and why"},
     {Event::release, "release", "who ended the stop, and why"},
     {Event::takeover, "takeover", "who said that another one leads"},
     {Event::order_refused, "order_refused", "an order that was not executed, and why"},
     {Event::consent, "consent", "the deadman is held"},
     {Event::consent_end, "consent_end", "it is not held any more"},
     {Event::refused, "refused", "commands that were refused or cut, by reason"}});

/// One line of an audit log: what happened before a robot hand.
struct Record {
  Time time{};
  std::string hand;
  Event event{};
  std::string who, what;    // what: the reason, or what was answered
  std::uint64_t count = 1;  // of refusals, since the line of the same kind before
};

/// A JSON object on one line, without the line's end.
std::string to_line(const Record& record);

/// What a line says. An error where it is no such line; unknown fields are passed by.
Expected<Record> parse(std::string_view line);

/// «2026-11-21T17:00:00.123Z»
std::string to_text(Time time);

}  // namespace prehend::audit
