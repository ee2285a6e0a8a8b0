#pragma once

#include <string>
#include <string_view>

namespace prehend {

/// A text as it stands in HTML, between elements or as the value of an attribute: a file, a hand or
/// a class may be called anything.
inline std::string html_escaped(std::string_view text) {
  std::string html;
  html.reserve(text.size());
  for (const char c : text) {
    if (c == '&')
      html += "&amp;";
    else if (c == '<')
      html += "&lt;";
    else if (c == '>')
      html += "&gt;";
    else if (c == '"')
      html += "&quot;";
    else
      html += c;
  }
  return html;
}

}  // namespace prehend
