#include "common/serial/overheard.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

#include "common/base/printable.hpp"

namespace prehend::serial {
namespace {

constexpr std::size_t max_quote = 40;  // characters, and three dots
constexpr std::string_view before_quote = "; heard instead: «";

bool is_line_end(char c) {
  return c == '\r' || c == '\n';
}

bool is_of_text(char c) {
  return (c >= ' ' && c <= '~') || c == '\t' || is_line_end(c);
}

/// The last whole line that says anything, or else all that there is.
std::string_view last_line(std::string_view text) {
  const auto blank = [](char c) { return c <= ' '; };
  while (!text.empty()) {
    const std::size_t end = text.find_last_of("\r\n");
    if (end == std::string_view::npos) break;
    const std::string_view whole = text.substr(0, end);
    const std::size_t before = whole.find_last_of("\r\n");
    const std::size_t begin = before == std::string_view::npos ? 0 : before + 1;
    if (!std::all_of(whole.begin() + static_cast<std::ptrdiff_t>(begin), whole.end(), blank))
      return whole.substr(begin);
    text = whole;
  }
  return text;
}

/// As it may stand on a terminal, and no longer than a glance.
std::string quoted(std::string_view bytes) {
  std::string shown;
  for (const char c : bytes) {
    const std::string next = printable({&c, 1});
    if (shown.size() + next.size() > max_quote) return shown + "...";
    shown += next;
  }
  return shown;
}

bool tells_place(std::string_view line) {
  // $GPGGA,… : five letters after the dollar.
  return line.size() > 7 && line[0] == '$' && line[6] == ',' &&
         std::all_of(line.begin() + 1, line.begin() + 6,
                     [](char c) { return c >= 'A' && c <= 'Z'; });
}

std::string advice(Speaker speaker) {
  switch (speaker) {
    case Speaker::ourselves:
      return "our own words come back: is the device on, and are the wires to and from it apart?";
    case Speaker::satellites:
      return "that is a GPS receiver: name the port of the device";
    case Speaker::text:
      return "another device, or one that starts anew: name the port of the device, or wait until "
             "it "
             "has started";
    case Speaker::bytes:
      break;
  }
  return "no text and no answer: check the baud rate, then whether it is the port of the device";
}

/// What is said, and what is quoted.
std::pair<std::string_view, std::string_view> parted(std::string_view message) {
  const std::size_t at = message.find(before_quote);
  if (at == std::string_view::npos) return {message, {}};
  const std::size_t begin = at + before_quote.size();
  return {message.substr(0, begin), message.substr(begin, message.find("»", begin) - begin)};
}

bool has_words(std::string_view quote) {
  return std::any_of(quote.begin(), quote.end(),
                     [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; });
}

}  // namespace

void Overheard::keep(std::string& all, std::string_view bytes, std::size_t size) {
  all.append(bytes);
  if (all.size() > size) all.erase(0, all.size() - size);
}

std::optional<Speaker> Overheard::speaker() const {
  if (heard_.empty()) return std::nullopt;
  if (heard_.size() > 1 && said_.find(heard_) != std::string::npos) return Speaker::ourselves;
  const auto text = std::count_if(heard_.begin(), heard_.end(), is_of_text);
  if (10 * static_cast<std::size_t>(text) < 9 * heard_.size()) return Speaker::bytes;
  return tells_place(last_line(heard_)) ? Speaker::satellites : Speaker::text;
}

Error Overheard::unanswered(Error silence) const {
  const auto who = speaker();
  if (!who) return silence;
  silence.what += std::string(before_quote) +
                  quoted(*who == Speaker::bytes ? std::string_view(heard_) : last_line(heard_)) +
                  "»";
  silence.hint = advice(*who);
  return silence;
}

bool is_news(std::string_view message, std::string_view before) {
  const auto [said, quote] = parted(message);
  const auto [said_before, quote_before] = parted(before);
  return said != said_before || (has_words(quote) && !has_words(quote_before));
}

}  // namespace prehend::serial
