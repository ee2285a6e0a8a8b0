#include "common/model/grasp_taxonomy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "common/base/parse_file.hpp"
#include "common/base/paths.hpp"
#include "common/base/toml_document.hpp"

namespace prehend::model {

namespace {

constexpr int feix_classes = 33;
constexpr std::array robot_types{"power wrap", "circular sphere", "precision"};
constexpr double octave = 0.5;  // standard deviation of a width outside its range

bool is_robot_type(std::string_view name) {
  return std::find(robot_types.begin(), robot_types.end(), name) != robot_types.end();
}

/// One value of a named table of values.
template <class Names>
auto one_of(const toml::table& table, const char* key, const Names& names)
    -> Expected<decltype(names.rows[0].value)> {
  const auto value = names.value(table[key].value_or(std::string_view{}));
  if (!value) return fail(fmt::format("{} is none of {}", key, names.list()));
  return *value;
}

/// Some of them.
template <class Value>
Expected<std::vector<Value>> some_of(const toml::table& table, const char* key, const auto& value,
                                     const std::string& list) {
  const toml::array* array = table[key].as_array();
  if (!array) return fail(fmt::format("{} is no list of {}", key, list));
  std::vector<Value> made;
  for (const toml::node& entry : *array) {
    const auto found = value(entry.value_or(std::string_view{}));
    if (!found || std::find(made.begin(), made.end(), *found) != made.end())
      return fail(fmt::format("{} has what is none of {}, or twice", key, list));
    made.push_back(*found);
  }
  return made;
}

Expected<void> read_words(const toml::table& table, GraspClass& made) {
  const auto put = [&](auto& to, const char* key, const auto& names) -> Expected<void> {
    auto value = one_of(table, key, names);
    if (!value) return tl::unexpected(value.error());
    to = *value;
    return {};
  };
  if (auto ok = put(made.kind, "kind", grasp_kinds); !ok) return ok;
  if (auto ok = put(made.form, "form", grasp_forms); !ok) return ok;
  if (auto ok = put(made.opposition, "opposition", oppositions); !ok) return ok;
  if (auto ok = put(made.thumb, "thumb", thumb_places); !ok) return ok;
  return put(made.approach, "approach", approaches);
}

Expected<void> read_lists(const toml::table& table, GraspClass& made) {
  auto opposed = some_of<Finger>(table, "opposed", finger_from_string, finger_names.list());
  if (!opposed) return tl::unexpected(opposed.error());
  auto blocks = some_of<ObjectPart>(
      table, "blocks", [](std::string_view name) { return object_parts.value(name); },
      object_parts.list());
  if (!blocks) return tl::unexpected(blocks.error());
  const auto known = [](std::string_view name) {
    const auto kind = shape_from_string(name);
    return kind == ShapeKind::unknown ? std::nullopt : kind;
  };
  auto shapes = some_of<ShapeKind>(table, "shapes", known, shape_words());
  if (!shapes) return tl::unexpected(shapes.error());
  if (opposed->empty() || shapes->empty()) return fail("opposed and shapes may not be empty");
  made.opposed = std::move(*opposed);
  made.blocks = std::move(*blocks);
  made.shapes = std::move(*shapes);
  return {};
}

Expected<GraspClass> read_class(const toml::table& table) {
  GraspClass made;
  made.name = table["name"].value_or("");
  if (made.name.empty() || made.name.size() > 64) return fail("needs a name of 1 to 64 bytes");
  made.feix = table["feix"].value_or(0);
  if (made.feix < 1 || made.feix > feix_classes)
    return fail(fmt::format("feix is no number from 1 to {}", feix_classes));
  if (auto ok = read_words(table, made); !ok) return tl::unexpected(ok.error());
  if (auto ok = read_lists(table, made); !ok) return tl::unexpected(ok.error());
  made.min_width = table["width"][0].value_or(0.0);
  made.max_width = table["width"][1].value_or(0.0);
  if (!(made.min_width > 0) || !(made.max_width > made.min_width) || made.max_width > 1)
    return fail("width needs two numbers, the least and the greatest, in m");
  made.robot = table["robot"].value_or("");
  if (!is_robot_type(made.robot))
    return fail(fmt::format("robot is none of {}", fmt::join(robot_types, ", ")));
  return made;
}

/// What is between the fingers, whether they come from the side or from above: the narrower way
/// across the object as it stands.
double width_of(const Shape& shape) {
  const Eigen::Vector3d half = half_extents(shape);
  return 2 * std::min(half.x(), half.y());
}

}  // namespace

bool GraspClass::blocked(ObjectPart part) const {
  return std::find(blocks.begin(), blocks.end(), part) != blocks.end();
}

Expected<GraspTaxonomy> GraspTaxonomy::parse(std::string_view text) {
  const auto document = parse_toml(text, {}, "a taxonomy of grasps is TOML");
  if (!document) return tl::unexpected(document.error());
  const toml::table& root = *document;
  const toml::array* entries = root["class"].as_array();
  if (!entries || entries->empty()) return fail("has no [[class]]", {}, "list at least one");
  GraspTaxonomy made;
  for (const toml::node& entry : *entries) {
    const std::string where = fmt::format("class {}", made.classes_.size() + 1);
    const toml::table* table = entry.as_table();
    if (!table) return fail("is no table", where, "write [[class]]");
    auto read = read_class(*table);
    if (!read) return fail(read.error().what, where, "see common/models/grasps/taxonomy.toml");
    if (made.find(read->name)) return fail("two classes named " + read->name, where);
    made.classes_.push_back(std::move(*read));
  }
  if (const toml::table* hands = root["robot"].as_table())
    for (const auto& [hand, types] : *hands) {
      const std::string where = fmt::format("robot.{}", hand.str());
      const toml::table* table = types.as_table();
      if (!table) return fail("is no table", where, "write [" + where + "]");
      for (const auto& [type, other] : *table) {
        const std::string instead = other.value_or("");
        if (!is_robot_type(type.str()) || !is_robot_type(instead))
          return fail(fmt::format("a type is none of {}", fmt::join(robot_types, ", ")), where);
        made.instead_[std::string(hand.str())][std::string(type.str())] = instead;
      }
    }
  return made;
}

Expected<GraspTaxonomy> GraspTaxonomy::load(const std::filesystem::path& file) {
  return parse_file(file, &GraspTaxonomy::parse);
}

Expected<GraspTaxonomy> GraspTaxonomy::of_the_house() {
  return load(share_directory() / "models" / "grasps" / "taxonomy.toml");
}

const GraspClass* GraspTaxonomy::find(std::string_view name) const {
  const auto found = std::find_if(classes_.begin(), classes_.end(),
                                  [&](const GraspClass& one) { return one.name == name; });
  return found == classes_.end() ? nullptr : &*found;
}

const std::string& GraspTaxonomy::robot_type(const GraspClass& grasp,
                                             const std::string& hand) const {
  const auto own = instead_.find(hand);
  if (own == instead_.end()) return grasp.robot;
  const auto found = own->second.find(grasp.robot);
  return found == own->second.end() ? grasp.robot : found->second;
}

std::vector<double> GraspTaxonomy::fit_to_object(const Shape& shape) const {
  std::vector<double> made;
  for (const GraspClass& one : classes_) {
    const bool known = is_valid(shape);
    const bool shaped =
        std::find(one.shapes.begin(), one.shapes.end(), shape.kind) != one.shapes.end();
    if (known && !shaped) {
      made.push_back(0);
      continue;
    }
    const double width = known ? width_of(shape) : one.min_width;
    const double nearest = std::clamp(width, one.min_width, one.max_width);
    const double off = std::log2(width / nearest) / octave;
    made.push_back(std::exp(-0.5 * off * off));
  }
  return made;
}

std::vector<double> GraspTaxonomy::fit_to_task(const std::vector<ObjectPart>& needed) const {
  std::vector<double> made;
  for (const GraspClass& one : classes_)
    made.push_back(std::none_of(needed.begin(), needed.end(),
                                [&](ObjectPart part) { return one.blocked(part); })
                       ? 1
                       : 0);
  return made;
}

}  // namespace prehend::model
