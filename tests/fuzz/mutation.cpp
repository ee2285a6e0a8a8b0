#include "tests/fuzz/mutation.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

namespace prehend::fuzz {
namespace {

/// A part of a text.
struct Piece {
  std::size_t begin = 0, size = 0;
};

Piece any_piece(Random& random, const std::string& text, std::size_t most) {
  const std::size_t begin = random.index(text.size() + 1);
  return {begin, std::min(text.size() - begin, random.index(most + 1))};
}

std::string cut_out(std::string& text, Piece piece) {
  const std::string part = text.substr(piece.begin, piece.size);
  text.erase(piece.begin, piece.size);
  return part;
}

/// Deletes, doubles or moves a piece; a move goes to the begin of one of the others.
void rearrange(Random& random, std::string& text, const std::vector<Piece>& pieces) {
  if (pieces.empty()) return;
  const Piece piece = pieces[random.index(pieces.size())];
  const std::size_t to = pieces[random.index(pieces.size())].begin;
  const std::string part = text.substr(piece.begin, piece.size);
  switch (random.index(3)) {
    case 0:
      cut_out(text, piece);
      break;
    case 1:
      text.insert(to, part);
      break;
    default:
      cut_out(text, piece);
      text.insert(std::min(to, text.size()), part);
  }
}

std::vector<Piece> numbers_of(const std::string& text) {
  std::vector<Piece> found;
  const auto part_of_number = [&](std::size_t i) {
    const unsigned char c = static_cast<unsigned char>(text[i]);
    return std::isdigit(c) || c == '.' || c == '-' || c == '+' || c == 'e';
  };
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i;
    while (end < text.size() && part_of_number(end)) ++end;
    const auto begin = text.begin();
    if (std::any_of(begin + static_cast<std::ptrdiff_t>(i),
                    begin + static_cast<std::ptrdiff_t>(end),
                    [](unsigned char c) { return std::isdigit(c); }))
      found.push_back({i, end - i});
    i = std::max(end, i + 1);
  }
  return found;
}

/// Elements with what is in them, up to the next end tag of the name. Not more than a thousand: the
/// search is quadratic in a deeply nested text.
std::vector<Piece> elements_of(const std::string& text) {
  std::vector<Piece> found;
  for (std::size_t i = 0; found.size() < 1000 && (i = text.find('<', i)) != std::string::npos;
       ++i) {
    if (i + 1 >= text.size() || !std::isalpha(static_cast<unsigned char>(text[i + 1]))) continue;
    const std::size_t close = text.find('>', i);
    if (close == std::string::npos) break;
    if (text[close - 1] == '/') {
      found.push_back({i, close + 1 - i});
      continue;
    }
    const std::size_t name_end = text.find_first_of(" \n\t>", i);
    const std::string end_tag = "</" + text.substr(i + 1, name_end - i - 1) + ">";
    const std::size_t end = text.find(end_tag, close);
    if (end != std::string::npos) found.push_back({i, end + end_tag.size() - i});
  }
  return found;
}

/// What stands between quotes, and with `whole` the name and the quotes too.
std::vector<Piece> attributes_of(const std::string& text, bool whole) {
  std::vector<Piece> found;
  for (std::size_t i = 0; (i = text.find("=\"", i)) != std::string::npos; i += 2) {
    const std::size_t end = text.find('"', i + 2);
    if (end == std::string::npos) break;
    const std::size_t begin = whole ? text.find_last_of(" \n<", i) + 1 : i + 2;
    found.push_back({begin, end + (whole ? 1 : 0) - begin});
  }
  return found;
}

std::vector<Piece> lines_of(const std::string& text) {
  std::vector<Piece> found;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
    found.push_back({begin, end - begin});
    begin = end;
  }
  return found;
}

}  // namespace

std::string mutate_bytes(Random& random, std::string bytes) {
  const std::size_t changes = 1 + random.index(8);
  for (std::size_t i = 0; i < changes && !bytes.empty(); ++i) {
    const std::size_t at = random.index(bytes.size());
    switch (random.index(5)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.index(8)));
        break;
      case 1:
        bytes[at] = static_cast<char>(random.bits());
        break;
      case 2:
        if (random.index(8) == 0) bytes.resize(at);
        break;
      default:
        rearrange(random, bytes, {any_piece(random, bytes, 200), any_piece(random, bytes, 200)});
    }
  }
  return bytes;
}

std::string mutate_number(Random& random, std::string text) {
  static const std::array<const char*, 19> wild{
      "nan", "-nan", "inf",   "-inf", "1e308", "-1e308",     "1e-308", "1e999",       "0", "-0",
      "-1",  "1",    "1e-12", "1e6",  "",      "2147483648", "0x10",   "0.1 0.2 0.3", "x"};
  const std::vector<Piece> numbers = numbers_of(text);
  if (numbers.empty()) return text;
  const Piece piece = numbers[random.index(numbers.size())];
  const Piece other = numbers[random.index(numbers.size())];
  const std::string value =
      random.index(4) == 0 ? text.substr(other.begin, other.size) : wild[random.index(wild.size())];
  return text.replace(piece.begin, piece.size, value);
}

std::string mutate_xml(Random& random, std::string text) {
  const std::vector<Piece> values = attributes_of(text, false);
  switch (random.index(5)) {
    case 0:
    case 1:
      rearrange(random, text, elements_of(text));
      break;
    case 2: {
      if (values.empty()) break;
      const Piece piece = values[random.index(values.size())];
      const Piece other = values[random.index(values.size())];
      text.replace(piece.begin, piece.size, text.substr(other.begin, other.size));
      break;
    }
    case 3:
      rearrange(random, text, attributes_of(text, true));
      break;
    default: {
      // Deep nesting finds readers that recurse without end.
      const std::vector<Piece> elements = elements_of(text);
      if (elements.empty()) break;
      const Piece piece = elements[random.index(elements.size())];
      const std::size_t depth = random.index(40) == 0 ? 200000 : 1 + random.index(5);
      std::string begin, end;
      for (std::size_t i = 0; i < depth; ++i) begin += "<a>", end += "</a>";
      text.insert(piece.begin + piece.size, end).insert(piece.begin, begin);
    }
  }
  return text;
}

std::string mutate_lines(Random& random, std::string text) {
  if (random.index(4) != 0) {
    rearrange(random, text, lines_of(text));
    return text;
  }
  const std::vector<Piece> lines = lines_of(text);
  if (lines.empty()) return text;
  const Piece line = lines[random.index(lines.size())];
  const std::size_t equals = text.find('=', line.begin);
  if (equals < line.begin + line.size) text.erase(equals + 1, line.begin + line.size - equals - 2);
  return text;
}

std::string mutate_text(Random& random, std::string text,
                        const std::function<std::string(Random&, std::string)>& mutate_structure) {
  for (std::size_t i = 0, changes = 1 + random.index(3); i < changes; ++i)
    switch (random.index(5)) {
      case 0:
        text = mutate_bytes(random, std::move(text));
        break;
      case 1:
      case 2:
        text = mutate_number(random, std::move(text));
        break;
      default:
        text = mutate_structure(random, std::move(text));
    }
  return text;
}

}  // namespace prehend::fuzz
