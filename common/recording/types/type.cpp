#include "common/recording/types/type.hpp"

#include <algorithm>

namespace prehend::recording::types {

std::string_view Enumeration::name_of(std::uint32_t value) const {
  for (const auto& [name_of_value, each] : enumerators)
    if (each == value) return name_of_value;
  return {};
}

const Field* Structure::find(std::string_view field) const {
  const auto found = std::ranges::find(fields, field, &Field::name);
  return found == fields.end() ? nullptr : &*found;
}

const Structure* Library::find(std::string_view name) const {
  const auto found = structures_.find(name);
  return found == structures_.end() ? nullptr : found->second.get();
}

const Enumeration* Library::find_enumeration(std::string_view name) const {
  const auto found = enumerations_.find(name);
  return found == enumerations_.end() ? nullptr : found->second.get();
}

Expected<const Structure*> Library::add(Structure structure) {
  const std::string name = structure.name;
  if (structures_.contains(name) || enumerations_.contains(name))
    return fail("the type " + name + " is defined twice");
  for (const Field& field : structure.fields)
    if (field.type.structure)
      structure.depth = std::max(structure.depth, field.type.structure->depth + 1);
  if (structure.depth > max_depth)
    return fail("the type " + name + " has too many structures inside each other");
  return (structures_[name] = std::make_unique<Structure>(std::move(structure))).get();
}

Expected<const Enumeration*> Library::add(Enumeration enumeration) {
  const std::string name = enumeration.name;
  if (structures_.contains(name) || enumerations_.contains(name))
    return fail("the type " + name + " is defined twice");
  return (enumerations_[name] = std::make_unique<Enumeration>(std::move(enumeration))).get();
}

}  // namespace prehend::recording::types
