#include "services/console/core/view.hpp"

#include <limits>

namespace prehend::console {

using recording::types::Enumerator;

View View::operator[](std::string_view field) const {
  View found;
  if (value_) found.value_ = value_->find(field);
  return found;
}

std::vector<View> View::elements() const {
  std::vector<View> all;
  if (const auto* list = value_ ? std::get_if<Value::List>(&value_->content) : nullptr)
    for (const Value& element : *list) all.emplace_back(element);
  return all;
}

double View::number() const {
  if (!value_) return std::numeric_limits<double>::quiet_NaN();
  if (const auto* n = std::get_if<double>(&value_->content)) return *n;
  if (const auto* n = std::get_if<std::int64_t>(&value_->content)) return static_cast<double>(*n);
  if (const auto* n = std::get_if<std::uint64_t>(&value_->content)) return static_cast<double>(*n);
  return std::numeric_limits<double>::quiet_NaN();
}

std::int64_t View::integer() const {
  if (!value_) return 0;
  if (const auto* n = std::get_if<std::int64_t>(&value_->content)) return *n;
  if (const auto* n = std::get_if<std::uint64_t>(&value_->content))
    return static_cast<std::int64_t>(*n);
  return 0;
}

bool View::flag() const {
  const auto* yes = value_ ? std::get_if<bool>(&value_->content) : nullptr;
  return yes && *yes;
}

std::string View::text() const {
  if (!value_) return {};
  if (const auto* text = std::get_if<std::string>(&value_->content)) return *text;
  if (const auto* one = std::get_if<Enumerator>(&value_->content)) return std::string(one->name);
  return {};
}

std::string_view View::bytes() const {
  const auto* bytes = value_ ? std::get_if<Value::Bytes>(&value_->content) : nullptr;
  if (!bytes) return {};
  return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
}

std::vector<double> View::numbers() const {
  std::vector<double> all;
  for (const View& element : elements()) all.push_back(element.number());
  return all;
}

Eigen::Vector3d View::vector() const {
  return {(*this)["x"].number(), (*this)["y"].number(), (*this)["z"].number()};
}

Expected<Pose> View::pose() const {
  const View q = (*this)["orientation"];
  return checked_pose((*this)["position"].vector(),
                      {q["w"].number(), q["x"].number(), q["y"].number(), q["z"].number()});
}

}  // namespace prehend::console
