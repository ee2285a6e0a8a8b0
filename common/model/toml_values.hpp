#pragma once

#include <toml++/toml.h>

#include <Eigen/Core>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/named_values.hpp"
#include "common/base/pose.hpp"

/// Values of hand.toml and arm.toml. `where` says whose value it is, for messages.
namespace prehend::model {

/// The same error with the file before its place.
Error located(Error error, const std::string& file);

/// A misspelt key must not pass as an absent one. hint: where all keys stand.
Expected<void> only_keys(const toml::table& table, std::initializer_list<std::string_view> allowed,
                         const std::string& where, const std::string& hint);

Expected<double> number(const toml::node& node, const std::string& where);

/// The number of a key, or `otherwise` where the key is absent.
Expected<double> number_or(const toml::table& table, std::string_view key, double otherwise,
                           const std::string& where);

Expected<std::string> text_of(const toml::table& table, std::string_view key,
                              const std::string& where);

/// Numbers of a TOML array, exactly `count` of them and finite.
Expected<Eigen::VectorXd> numbers(const toml::node* node, std::size_t count,
                                  const std::string& where);

/// The entries of [[key]], 1 to 32 tables.
Expected<std::vector<const toml::table*>> entries(const toml::table& root, const std::string& key);

/// The table of a key, empty where the key is absent.
Expected<toml::table> table_of(const toml::table& root, const std::string& key);

/// The pose of [key]: position (m) and orientation (w, x, y, z). Both must be there.
Expected<Pose> pose_in(const toml::table& root, const std::string& key, const std::string& hint);

/// The place of the item of this name, or -1.
template <class Items>
int find_named(const Items& items, std::string_view name) {
  for (std::size_t i = 0; i < items.size(); ++i)
    if (items[i].name == name) return static_cast<int>(i);
  return -1;
}

/// The value of a word of the table; nothing: the key was left out.
template <class E, std::size_t N>
Expected<std::optional<E>> named_of(const toml::table& table, std::string_view key,
                                    const NamedValues<E, N>& names, const std::string& where) {
  if (!table.contains(key)) return std::optional<E>();
  const auto word = text_of(table, key, where);
  if (!word) return tl::unexpected(word.error());
  const auto value = names.value(*word);
  if (!value) return fail("«" + std::string(key) + "» is «" + *word + "»", where, names.list());
  return value;
}

}  // namespace prehend::model
