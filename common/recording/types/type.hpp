#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/error.hpp"

namespace prehend::recording::types {

enum class Kind {
  boolean,
  character,
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  float32,
  float64,
  string,
  enumeration,
  structure
};

struct Enumeration {
  std::string name;  // scoped, as prehend::v1::ShapeKind
  std::vector<std::pair<std::string, std::uint32_t>> enumerators;

  /// Empty for a value that it does not have.
  std::string_view name_of(std::uint32_t value) const;
};

struct Structure;

/// What a field holds: one, a fixed number or any number of elements of a kind.
struct Type {
  enum class Many { one, array, sequence };

  Kind kind = Kind::boolean;
  const Enumeration* enumeration = nullptr;
  const Structure* structure = nullptr;
  std::uint32_t string_bound = 0;  // 0: none
  Many many = Many::one;
  std::uint32_t count = 0;  // of an array (all its dimensions), bound of a sequence (0: none)
};

struct Field {
  std::string name;
  Type type;
  bool key = false;
};

/// A topic's type, or a part of one.
struct Structure {
  std::string name;  // scoped
  std::vector<Field> fields;
  /// Structures inside each other, with this one; set by Library::add().
  int depth = 1;
  /// The IDL that it was read from, one self-contained text with its comments; empty when it was
  /// not IDL.
  std::shared_ptr<const std::string> source;

  const Field* find(std::string_view field) const;
};

/// Owner of types; what it hands out lives as long as it does. Types refer only to types that were
/// there before, so there are no cycles.
class Library {
 public:
  /// Structures inside each other, at most: whoever walks through a type may recurse.
  static constexpr int max_depth = 64;

  /// Nothing when it is not there.
  const Structure* find(std::string_view name) const;
  const Enumeration* find_enumeration(std::string_view name) const;
  const std::map<std::string, std::unique_ptr<Structure>, std::less<>>& structures() const {
    return structures_;
  }

  /// Fails when the name is taken or the type is too deep.
  Expected<const Structure*> add(Structure structure);
  Expected<const Enumeration*> add(Enumeration enumeration);

 private:
  std::map<std::string, std::unique_ptr<Structure>, std::less<>> structures_;
  std::map<std::string, std::unique_ptr<Enumeration>, std::less<>> enumerations_;
};

}  // namespace prehend::recording::types
