#include "common/recording/compare/tolerance.hpp"

#include "common/base/file_text.hpp"
#include "common/base/paths.hpp"
#include "common/base/toml_document.hpp"

namespace prehend::recording {
namespace {

Expected<Tolerance> tolerance_of(const toml::node& node, const std::string& where) {
  Tolerance tolerance;
  if (const auto number = node.value<double>()) {
    tolerance.absolute = *number;
  } else if (node.value<std::string>() == "ignore") {
    tolerance.ignored = true;
  } else if (const toml::table* table = node.as_table()) {
    tolerance.absolute = (*table)["absolute"].value_or(0.0);
    tolerance.relative = (*table)["relative"].value_or(0.0);
    for (const auto& [key, value] : *table)
      if (key != "absolute" && key != "relative")
        return fail("«" + std::string(key.str()) + "» is not known", where,
                    "absolute and relative are");
  } else {
    return fail("is no tolerance", where, "a number, \"ignore\" or {absolute = a, relative = r}");
  }
  if (!(tolerance.absolute >= 0) || !(tolerance.relative >= 0))
    return fail("a tolerance is 0 or more", where);
  return tolerance;
}

}  // namespace

Expected<ToleranceTable> ToleranceTable::parse(std::string_view text, const std::string& origin) {
  const auto document = parse_toml(text, origin, "tolerances are TOML");
  if (!document) return tl::unexpected(document.error());
  ToleranceTable result;
  for (const auto& [type, node] : *document) {
    const std::string name(type.str());
    const toml::table* fields = node.as_table();
    if (!fields) return fail("is no table of fields", origin + ": " + name);
    for (const auto& [field, value] : *fields) {
      const std::string path(field.str());
      const auto tolerance = tolerance_of(value, origin + ": " + name + "." + path);
      if (!tolerance) return tl::unexpected(tolerance.error());
      result.types_[name].emplace(path, *tolerance);
    }
  }
  return result;
}

Expected<ToleranceTable> ToleranceTable::load(const std::filesystem::path& file) {
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  return parse(*text, file.string());
}

Expected<ToleranceTable> ToleranceTable::load_defaults() {
  return load(share_directory() / "tolerances.toml");
}

Tolerance ToleranceTable::of(std::string_view type, std::string_view path) const {
  if (const auto fields = types_.find(type); fields != types_.end()) {
    for (std::string_view part = path; !part.empty();) {
      if (const auto entry = fields->second.find(part); entry != fields->second.end())
        return entry->second;
      const std::size_t dot = part.rfind('.');
      part = dot == std::string_view::npos ? std::string_view{} : part.substr(0, dot);
    }
  }
  if (const auto any = types_.find("any"); any != types_.end()) {
    const std::size_t dot = path.rfind('.');
    const std::string_view last = dot == std::string_view::npos ? path : path.substr(dot + 1);
    for (const std::string_view name : {last, std::string_view("number")})
      if (const auto entry = any->second.find(name); entry != any->second.end())
        return entry->second;
  }
  return {};
}

std::vector<std::string> ToleranceTable::types() const {
  std::vector<std::string> names;
  for (const auto& [type, fields] : types_) names.push_back(type);
  return names;
}

std::vector<std::string> ToleranceTable::fields(std::string_view type) const {
  std::vector<std::string> paths;
  if (const auto found = types_.find(type); found != types_.end())
    for (const auto& [path, tolerance] : found->second) paths.push_back(path);
  return paths;
}

}  // namespace prehend::recording
