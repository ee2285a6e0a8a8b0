#include "common/model/toml_values.hpp"

#include <algorithm>
#include <cmath>

namespace prehend::model {
namespace {

constexpr std::size_t max_entries = 32;

}  // namespace

Error located(Error error, const std::string& file) {
  error.where = file + (error.where.empty() ? "" : ": " + error.where);
  return error;
}

Expected<void> only_keys(const toml::table& table, std::initializer_list<std::string_view> allowed,
                         const std::string& where, const std::string& hint) {
  for (const auto& [key, node] : table)
    if (std::find(allowed.begin(), allowed.end(), key.str()) == allowed.end())
      return fail("unknown key \"" + std::string(key.str()) + "\"", where, hint);
  return {};
}

Expected<double> number(const toml::node& node, const std::string& where) {
  const auto value = node.is_number() ? node.value<double>() : std::nullopt;
  if (!value || !std::isfinite(*value)) return fail("needs a finite number", where);
  return *value;
}

Expected<double> number_or(const toml::table& table, std::string_view key, double otherwise,
                           const std::string& where) {
  const toml::node* node = table.get(key);
  return node ? number(*node, where + "." + std::string(key)) : otherwise;
}

Expected<std::string> text_of(const toml::table& table, std::string_view key,
                              const std::string& where) {
  const auto value = table[key].value<std::string>();
  if (!value || value->empty()) return fail("needs a text \"" + std::string(key) + "\"", where);
  return *value;
}

Expected<Eigen::VectorXd> numbers(const toml::node* node, std::size_t count,
                                  const std::string& where) {
  const toml::array* array = node ? node->as_array() : nullptr;
  if (!array || array->size() != count)
    return fail("needs " + std::to_string(count) + " numbers", where);
  Eigen::VectorXd values(static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const auto value = number(*array->get(i), where);
    if (!value) return tl::unexpected(value.error());
    values[static_cast<Eigen::Index>(i)] = *value;
  }
  return values;
}

Expected<std::vector<const toml::table*>> entries(const toml::table& root, const std::string& key) {
  const toml::array* array = root[key].as_array();
  if (!array || array->empty() || array->size() > max_entries ||
      !array->is_homogeneous(toml::node_type::table))
    return fail("needs 1 to 32 [[" + key + "]] entries");
  std::vector<const toml::table*> tables;
  for (const toml::node& node : *array) tables.push_back(node.as_table());
  return tables;
}

Expected<toml::table> table_of(const toml::table& root, const std::string& key) {
  const toml::node* node = root.get(key);
  if (!node) return toml::table();
  if (!node->is_table()) return fail("must be a table [" + key + "]", key);
  return *node->as_table();
}

Expected<Pose> pose_in(const toml::table& root, const std::string& key, const std::string& hint) {
  const auto table = table_of(root, key);
  if (!table) return tl::unexpected(table.error());
  if (auto known = only_keys(*table, {"position", "orientation"}, key, hint); !known)
    return tl::unexpected(known.error());
  const auto p = numbers(table->get("position"), 3, key + ".position");
  if (!p) return tl::unexpected(p.error());
  const auto q = numbers(table->get("orientation"), 4, key + ".orientation");
  if (!q) return tl::unexpected(q.error());
  const auto X =
      checked_pose(Eigen::Vector3d(*p), Eigen::Quaterniond((*q)[0], (*q)[1], (*q)[2], (*q)[3]));
  if (!X) return tl::unexpected(located(X.error(), key));
  return *X;
}

}  // namespace prehend::model
