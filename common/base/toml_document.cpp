#include "common/base/toml_document.hpp"

#include <cmath>
#include <optional>

#include "common/base/file_text.hpp"

namespace prehend {
namespace {

std::string at_line(const std::string& where, const toml::source_region& source) {
  return (where.empty() ? "" : where + ": ") + "line " + std::to_string(source.begin.line);
}

struct Found {
  const toml::node* node = nullptr;
  std::string key;
};

/// The first number below this node that is not finite, and its key.
std::optional<Found> infinite_in(const toml::node& node, const std::string& key) {
  if (const auto* number = node.as_floating_point(); number && !std::isfinite(number->get()))
    return Found{&node, key};
  if (const auto* table = node.as_table())
    for (const auto& [name, value] : *table) {
      const std::string below(name.str());
      if (auto found = infinite_in(value, key.empty() ? below : key + "." + below)) return found;
    }
  if (const auto* array = node.as_array())
    for (const auto& value : *array)
      if (auto found = infinite_in(value, key)) return found;
  return std::nullopt;
}

}  // namespace

Expected<toml::table> parse_toml(std::string_view text, const std::string& where,
                                 const std::string& hint) {
  toml::table root;
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& error) {
    return fail(std::string(error.description()), at_line(where, error.source()), hint);
  }
  if (const auto wrong = infinite_in(root, {}))
    return fail(wrong->key + " is not a finite number", at_line(where, wrong->node->source()),
                hint);
  return root;
}

Expected<toml::table> load_toml(const std::filesystem::path& file, const std::string& hint) {
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  return parse_toml(*text, file.string(), hint);
}

}  // namespace prehend
