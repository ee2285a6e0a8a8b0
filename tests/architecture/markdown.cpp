#include "tests/architecture/markdown.hpp"

#include <algorithm>
#include <cctype>
#include <map>

namespace prehend::architecture {
namespace {

// [text](link) leaves its text.
std::string without_links(std::string text) {
  for (auto at = text.find("]("); at != std::string::npos; at = text.find("]("))
    text.erase(at, text.find(')', at) - at + 1);
  return text;
}

// Signs of two or three bytes that are no letters: « · × – „ → ≤ and their like.
bool is_punctuation(std::string_view sign) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(sign[i]); };
  if (byte(0) == 0xC2) return byte(1) != 0xAA && byte(1) != 0xB5 && byte(1) != 0xBA;  // ª µ º
  if (byte(0) == 0xC3) return byte(1) == 0x97 || byte(1) == 0xB7;                     // × ÷
  return byte(0) == 0xE2 && (byte(1) < 0xB0);  // U+2000 to U+2BFF
}

/// Signs of a text in UTF-8, one by one.
std::vector<std::string> signs_of(std::string_view text) {
  std::vector<std::string> signs;
  while (!text.empty()) {
    const auto first = static_cast<unsigned char>(text.front());
    const std::size_t bytes = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    signs.emplace_back(text.substr(0, bytes));
    text.remove_prefix(signs.back().size());
  }
  return signs;
}

bool is_letter(const std::string& sign) {
  if (sign.size() > 1) return !is_punctuation(sign);
  return std::isalnum(static_cast<unsigned char>(sign.front())) != 0;
}

std::string slug_of(std::string_view heading) {
  heading.remove_prefix(heading.find_first_not_of("# "));
  std::string slug;
  for (const std::string& sign : signs_of(without_links(std::string(heading)))) {
    if (sign == " ") {
      slug += '-';
    } else if (sign.size() > 1 && is_letter(sign)) {
      slug += sign;
    } else if (is_letter(sign) || sign == "-" || sign == "_") {
      slug += static_cast<char>(std::tolower(static_cast<unsigned char>(sign.front())));
    }
  }
  return slug;
}

}  // namespace

std::vector<Line> prose_of(const File& page) {
  std::vector<Line> lines;
  bool fenced = false;
  for (std::size_t i = 0; i < page.lines.size(); ++i) {
    const std::string& text = page.lines[i];
    const auto begin = text.find_first_not_of(' ');
    if (begin != std::string::npos && text.compare(begin, 3, "```") == 0)
      fenced = !fenced;
    else if (!fenced)
      lines.push_back({static_cast<int>(i + 1), &text});
  }
  return lines;
}

bool is_heading(std::string_view line) {
  const auto end = line.find_first_not_of('#');
  return end != std::string_view::npos && end >= 1 && end <= 6 && line[end] == ' ' &&
         line.find_first_not_of(' ', end) != std::string_view::npos;
}

std::vector<std::string> slugs_of(const File& page) {
  std::vector<std::string> slugs;
  std::map<std::string, int> seen;
  for (const Line& line : prose_of(page)) {
    if (!is_heading(*line.text)) continue;
    std::string slug = slug_of(*line.text);
    if (const int count = seen[slug]++; count > 0) slug += "-" + std::to_string(count);
    slugs.push_back(std::move(slug));
  }
  return slugs;
}

int words_in(std::string_view text) {
  const std::vector<std::string> words = words_of(text);
  return static_cast<int>(std::count_if(words.begin(), words.end(), [](const std::string& word) {
    const std::vector<std::string> signs = signs_of(word);
    return std::any_of(signs.begin(), signs.end(), is_letter);
  }));
}

}  // namespace prehend::architecture
