#include "common/recording/types/schema_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <vector>

namespace prehend::recording::types {
namespace {

/// The types a type needs, each after those that it needs itself.
template <class Take>
void walk(const Structure& type, std::set<std::string>& seen, const Take& take) {
  for (const Field& field : type.fields) {
    if (field.type.enumeration && seen.insert(field.type.enumeration->name).second)
      take(nullptr, field.type.enumeration);
    if (field.type.structure && seen.insert(field.type.structure->name).second) {
      walk(*field.type.structure, seen, take);
      take(field.type.structure, nullptr);
    }
  }
}

const std::map<Kind, std::pair<std::string_view, std::string_view>>& words() {
  // ROS 2, IDL
  static const std::map<Kind, std::pair<std::string_view, std::string_view>> table{
      {Kind::boolean, {"bool", "boolean"}},
      {Kind::character, {"char", "char"}},
      {Kind::int8, {"int8", "int8"}},
      {Kind::uint8, {"uint8", "octet"}},
      {Kind::int16, {"int16", "short"}},
      {Kind::uint16, {"uint16", "unsigned short"}},
      {Kind::int32, {"int32", "long"}},
      {Kind::uint32, {"uint32", "unsigned long"}},
      {Kind::int64, {"int64", "long long"}},
      {Kind::uint64, {"uint64", "unsigned long long"}},
      {Kind::float32, {"float32", "float"}},
      {Kind::float64, {"float64", "double"}},
      {Kind::enumeration, {"uint32", "uint32"}},
      {Kind::string, {"string", "string"}}};
  return table;
}

/// Scope and last part of a name.
std::pair<std::string, std::string> split(std::string_view name) {
  const std::size_t at = name.rfind("::");
  if (at == std::string_view::npos) return {"", std::string(name)};
  return {std::string(name.substr(0, at)), std::string(name.substr(at + 2))};
}

/// a::b as a_b.
std::string package(std::string_view scope) {
  std::string name;
  for (std::size_t i = 0; i < scope.size(); ++i) {
    const bool pair = scope.substr(i, 2) == "::";
    name += pair ? '_' : scope[i];
    i += pair;
  }
  return name;
}

/// As it is written in fields: prehend_v1/Pose.
std::string short_ros2_name(std::string_view name) {
  const auto [scope, last] = split(name);
  return scope.empty() ? last : package(scope) + "/" + last;
}

std::string ros2_fields(const Structure& type) {
  std::string text;
  std::set<const Enumeration*> shown;
  for (const Field& field : type.fields) {
    const Type& kind = field.type;
    if (kind.enumeration && shown.insert(kind.enumeration).second)
      for (const auto& [name, value] : kind.enumeration->enumerators)
        text += fmt::format("uint32 {}={}\n", name, value);
    text += kind.structure ? short_ros2_name(kind.structure->name)
                           : std::string(words().at(kind.kind).first);
    if (kind.string_bound != 0) text += fmt::format("<={}", kind.string_bound);
    if (kind.many == Type::Many::array) text += fmt::format("[{}]", kind.count);
    if (kind.many == Type::Many::sequence)
      text += kind.count == 0 ? "[]" : fmt::format("[<={}]", kind.count);
    text += fmt::format(" {}\n", ros2_field_name(field.name));
  }
  return text;
}

std::string idl_definition(const Structure& type) {
  std::string text = fmt::format("@final struct {} {{\n", split(type.name).second);
  for (const Field& field : type.fields) {
    const Type& kind = field.type;
    std::string element = kind.structure     ? kind.structure->name
                          : kind.enumeration ? kind.enumeration->name
                                             : std::string(words().at(kind.kind).second);
    if (kind.string_bound != 0) element += fmt::format("<{}>", kind.string_bound);
    if (kind.many == Type::Many::sequence)
      element = kind.count == 0 ? fmt::format("sequence<{}>", element)
                                : fmt::format("sequence<{}, {}>", element, kind.count);
    const std::string size = kind.many == Type::Many::array ? fmt::format("[{}]", kind.count) : "";
    text += fmt::format("  {}{} {}{};\n", field.key ? "@key " : "", element, field.name, size);
  }
  return text + "};\n";
}

std::string idl_definition(const Enumeration& type) {
  std::string text = fmt::format("enum {} {{\n", split(type.name).second);
  for (std::size_t i = 0; i < type.enumerators.size(); ++i) {
    const auto& [name, value] = type.enumerators[i];
    text += value == i ? "  " : fmt::format("  @value({}) ", value);
    text += name + (i + 1 < type.enumerators.size() ? ",\n" : "\n");
  }
  return text + "};\n";
}

std::string in_modules(const std::string& name, const std::string& definition) {
  std::string text = definition, scope = split(name).first;
  while (!scope.empty()) {
    const auto [outer, inner] = split(scope);
    text = fmt::format("module {} {{\n{}}};\n", inner, text);
    scope = outer;
  }
  return text;
}

/// Reads the parts of a ros2msg text, of which each may use those behind it.
class Ros2Parser {
 public:
  Ros2Parser(std::string_view name, std::string_view text, Library& library) : library_(library) {
    std::string part(name);
    std::istringstream lines{std::string(text)};
    std::string line;
    while (std::getline(lines, line)) {
      if (line.starts_with("===")) continue;
      if (line.starts_with("MSG:")) {
        part = line.substr(std::min(line.find_first_not_of(' ', 4), line.size()));
        part.erase(part.find_last_not_of(" \r") + 1);
        continue;
      }
      parts_[part].push_back(line);
    }
  }

  Expected<const Structure*> structure(const std::string& wanted) {
    const auto part = find_part(wanted);
    if (part == parts_.end()) return fail("type " + wanted + " is not in its schema");
    if (const Structure* known = library_.find(part->first)) return known;
    if (!open_.insert(part->first).second) return fail("type " + wanted + " contains itself");
    if (++depth_ > Library::max_depth)
      return fail("the type " + wanted + " lies too deep inside others");
    Structure result{.name = part->first};
    for (const std::string& line : part->second) {
      auto field = this->field(line, wanted);
      if (!field) return fail(field.error().what, "field «" + line + "» of " + wanted);
      if (*field) result.fields.push_back(std::move(**field));
    }
    --depth_;
    return library_.add(std::move(result));
  }

 private:
  using Parts = std::map<std::string, std::vector<std::string>>;

  /// A type is named in full, without «msg» or without its package.
  Parts::const_iterator find_part(const std::string& wanted) const {
    const auto plain = [](std::string name) {
      if (const std::size_t at = name.find("/msg/"); at != std::string::npos) name.erase(at, 4);
      return name;
    };
    return std::ranges::find_if(parts_, [&](const auto& part) {
      const std::string a = plain(part.first), b = plain(wanted);
      return a == b || (b.find('/') == std::string::npos && a.ends_with(fmt::format("/{}", b)));
    });
  }

  Expected<std::optional<Field>> field(std::string line, const std::string& inside) {
    line.erase(std::min(line.find('#'), line.size()));
    std::istringstream words_in_line(line);
    std::string type_name, name;
    words_in_line >> type_name >> name;
    if (type_name.empty()) return std::nullopt;
    if (name.empty()) return fail("a field without a name");
    // NAME=VALUE and NAME = VALUE are constants.
    std::string after;
    words_in_line >> after;
    if (name.find('=') != std::string::npos || after.starts_with("=")) return std::nullopt;
    Type type;
    if (const std::size_t open = type_name.find('['); open != std::string::npos) {
      auto inner = type_name.substr(open + 1);
      if (!inner.ends_with("]")) return fail("«]» is missing");
      inner.pop_back();
      type.many =
          inner.empty() || inner.starts_with("<=") ? Type::Many::sequence : Type::Many::array;
      if (inner.starts_with("<=")) inner.erase(0, 2);
      if (!inner.empty() && !read(inner, type.count)) return fail("an impossible size");
      if (type.many == Type::Many::array && type.count == 0) return fail("an impossible size");
      type_name.erase(open);
    }
    if (const std::size_t bound = type_name.find("<="); bound != std::string::npos) {
      if (!read(type_name.substr(bound + 2), type.string_bound)) return fail("an impossible bound");
      type_name.erase(bound);
    }
    if (const Structure* time = time_of_ros1(type_name)) {
      type.kind = Kind::structure;
      type.structure = time;
    } else if (const auto kind = primitive(type_name)) {
      type.kind = *kind;
    } else {
      const auto nested = structure(qualified(type_name, inside));
      if (!nested) return tl::unexpected(nested.error());
      type.kind = Kind::structure;
      type.structure = *nested;
    }
    return Field{name, type};
  }

  /// A type without a package is one of the package it stands in, or in ROS 1 std_msgs/Header.
  std::string qualified(const std::string& type_name, const std::string& inside) const {
    if (type_name.find('/') != std::string::npos) return type_name;
    const std::string same = inside.substr(0, inside.find('/')) + "/" + type_name;
    return find_part(same) == parts_.end() ? type_name : same;
  }

  static bool read(std::string_view text, std::uint32_t& number) {
    const auto [stop, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
    return problem == std::errc() && stop == text.data() + text.size();
  }

  /// Two words of ROS 1 that are no types of their own elsewhere; else nothing.
  const Structure* time_of_ros1(const std::string& word) {
    if (word != "time" && word != "duration") return nullptr;
    if (const Structure* known = library_.find(word)) return known;
    const Kind kind = word == "time" ? Kind::uint32 : Kind::int32;
    const auto added = library_.add(
        {.name = word, .fields = {{"secs", {.kind = kind}}, {"nsecs", {.kind = kind}}}});
    return added ? *added : nullptr;
  }

  static std::optional<Kind> primitive(std::string_view word) {
    if (word == "byte" || word == "char") return Kind::uint8;
    for (const auto& [kind, names] : words())
      if (kind != Kind::enumeration && names.first == word) return kind;
    return std::nullopt;
  }

  Library& library_;
  Parts parts_;
  std::set<std::string> open_;
  int depth_ = 0;
};

}  // namespace

std::string ros2_name(std::string_view scoped_name) {
  const auto [scope, last] = split(scoped_name);
  return scope.empty() ? last : package(scope) + "/msg/" + last;
}

std::string ros2_field_name(std::string_view name) {
  std::string lower(name);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

std::string ros2msg(const Structure& type) {
  std::string text = ros2_fields(type);
  std::set<std::string> seen;
  walk(type, seen, [&](const Structure* structure, const Enumeration*) {
    if (structure)
      text += std::string(80, '=') + "\nMSG: " + short_ros2_name(structure->name) + "\n" +
              ros2_fields(*structure);
  });
  return text;
}

std::string omgidl(const Structure& type) {
  std::string text;
  std::set<std::string> seen;
  walk(type, seen, [&](const Structure* structure, const Enumeration* enumeration) {
    text += structure ? in_modules(structure->name, idl_definition(*structure))
                      : in_modules(enumeration->name, idl_definition(*enumeration));
  });
  return text + in_modules(type.name, idl_definition(type));
}

Expected<const Structure*> parse_ros2msg(std::string_view name, std::string_view text,
                                         Library& library) {
  return Ros2Parser(name, text, library).structure(std::string(name));
}

}  // namespace prehend::recording::types
