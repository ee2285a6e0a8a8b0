#include "services/recorder/tools/dataset/message.hpp"

#include <cctype>
#include <cmath>
#include <variant>

namespace prehend::recorder::dataset {
namespace {

std::optional<double> as_number(const Value& value) {
  if (const auto* real = std::get_if<double>(&value.content))
    return std::isfinite(*real) ? std::optional(*real) : std::nullopt;
  if (const auto* whole = std::get_if<std::int64_t>(&value.content))
    return static_cast<double>(*whole);
  if (const auto* whole = std::get_if<std::uint64_t>(&value.content))
    return static_cast<double>(*whole);
  return std::nullopt;
}

}  // namespace

std::optional<double> number(const Value& message, std::string_view field) {
  const Value* value = message.find(field);
  return value ? as_number(*value) : std::nullopt;
}

std::string text(const Value& message, std::string_view field) {
  const Value* value = message.find(field);
  if (!value) return "";
  if (const auto* words = std::get_if<std::string>(&value->content)) return *words;
  if (const auto* one = std::get_if<recording::types::Enumerator>(&value->content))
    return std::string(one->name);
  return "";
}

bool flag(const Value& message, std::string_view field) {
  const Value* value = message.find(field);
  const bool* yes = value ? std::get_if<bool>(&value->content) : nullptr;
  return yes && *yes;
}

std::optional<Eigen::VectorXd> numbers(const Value& message, std::string_view field) {
  const Value* value = message.find(field);
  const auto* list = value ? std::get_if<Value::List>(&value->content) : nullptr;
  if (!list) return std::nullopt;
  Eigen::VectorXd all(static_cast<Eigen::Index>(list->size()));
  for (std::size_t i = 0; i < list->size(); ++i) {
    const auto one = as_number((*list)[i]);
    if (!one) return std::nullopt;
    all[static_cast<Eigen::Index>(i)] = *one;
  }
  return all;
}

std::optional<Eigen::Vector3d> vector(const Value& message, std::string_view field) {
  const Value* value = message.find(field);
  if (!value) return std::nullopt;
  const auto x = number(*value, "x"), y = number(*value, "y"), z = number(*value, "z");
  if (!x || !y || !z) return std::nullopt;
  return Eigen::Vector3d(*x, *y, *z);
}

std::optional<Pose> pose(const Value& message, std::string_view field) {
  const Value* value = message.find(field);
  const Value* turn = value ? value->find("orientation") : nullptr;
  const auto position = value ? vector(*value, "position") : std::nullopt;
  if (!turn || !position) return std::nullopt;
  const auto w = number(*turn, "w"), x = number(*turn, "x"), y = number(*turn, "y"),
             z = number(*turn, "z");
  if (!w || !x || !y || !z) return std::nullopt;
  const auto checked = checked_pose(*position, Eigen::Quaterniond(*w, *x, *y, *z));
  return checked ? std::optional(*checked) : std::nullopt;
}

std::string as_name(std::string key) {
  for (char& c : key)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-') c = '_';
  return key.empty() ? "_" : key;
}

}  // namespace prehend::recorder::dataset
