#include "common/base/toml_text.hpp"

#include "common/base/file_text.hpp"

namespace prehend {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// Is this the line of that key?
bool sets(std::string_view text, std::string_view key) {
  return text.starts_with(key) && trimmed(text.substr(key.size())).starts_with('=');
}

}  // namespace

std::string with_line(std::string_view toml, std::string_view table, std::string_view key,
                      const std::string& line) {
  const std::string header = '[' + std::string(table) + ']';
  std::string result;
  bool inside = false, done = false;
  while (!toml.empty()) {
    const std::size_t end = toml.find('\n');
    const std::string_view old = toml.substr(0, end);
    toml.remove_prefix(end == std::string_view::npos ? toml.size() : end + 1);
    const std::string_view text = trimmed(old);
    const bool replaced = inside && sets(text, key);
    if (!replaced || !done) result += (replaced ? line : std::string(old)) + '\n';
    done = done || replaced;
    if (text.starts_with('[')) inside = text.starts_with(header);
  }
  if (done) return result;
  // No such line yet: right behind the table's header, which may have to be made.
  const std::size_t place = ('\n' + result).find('\n' + header);
  if (place == std::string::npos) return result + '\n' + header + '\n' + line + '\n';
  result.insert(result.find('\n', place) + 1, line + '\n');
  return result;
}

Expected<void> write_line(const std::filesystem::path& file, std::string_view table,
                          std::string_view key, const std::string& line) {
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  return write_file(file, with_line(*text, table, key, line));
}

}  // namespace prehend
