#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace prehend {

/// A value of an enumeration, what it is called in files and on the screen, and what it means.
template <class E>
struct NamedValue {
  E value{};
  std::string_view name;
  std::string_view help{};
};

/// The names of an enumeration: one table for writing, reading and listing them. Made by
/// named_values(). Which row comes first may matter to its owner; no value and no name is there
/// twice.
template <class E, std::size_t N>
struct NamedValues {
  std::array<NamedValue<E>, N> rows;

  /// Of a value that is not in the table (a message may carry any number): `otherwise`.
  constexpr std::string_view name(E value, std::string_view otherwise = "unknown") const {
    for (const NamedValue<E>& row : rows)
      if (row.value == value) return row.name;
    return otherwise;
  }
  constexpr std::optional<E> value(std::string_view name) const {
    for (const NamedValue<E>& row : rows)
      if (row.name == name) return row.value;
    return std::nullopt;
  }
  /// «a, b or c», for messages and help.
  std::string list(std::string_view last = " or ") const {
    std::string text;
    for (std::size_t i = 0; i < N; ++i) {
      if (i > 0) text += i + 1 == N ? last : ", ";
      text += rows[i].name;
    }
    return text;
  }

  constexpr auto begin() const { return rows.begin(); }
  constexpr auto end() const { return rows.end(); }
  static constexpr std::size_t size() { return N; }
};

/// named_values<Colour>({{Colour::red, "red"}, {Colour::blue, "blue", "for the sky"}})
template <class E, std::size_t N>
constexpr NamedValues<E, N> named_values(const NamedValue<E> (&rows)[N]) {
  NamedValues<E, N> made;
  for (std::size_t i = 0; i < N; ++i) made.rows[i] = rows[i];
  return made;
}

}  // namespace prehend
