#pragma once

#include <initializer_list>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/recording/types/idl.hpp"
#include "common/recording/types/value.hpp"
#include "tests/support/paths/paths.hpp"

/// What messages for nodes of ROS 2 say, read by their types in idl/ros2. Throws what is wrong.
namespace prehend::test {

using recording::types::Value;

inline Value ros_value(const std::string& type, const std::vector<std::uint8_t>& bytes) {
  static const auto types = recording::types::load_idl(test::in_sources("idl/ros2")).value();
  const auto* structure = types.find(type);
  if (!structure) throw std::runtime_error("no type " + type);
  auto value = recording::types::decode(*structure, bytes);
  if (!value) throw std::runtime_error(value.error().message());
  return *value;
}

inline const Value& in(const Value& value, std::initializer_list<const char*> path) {
  const Value* at = &value;
  for (const char* field : path) {
    at = at->find(field);
    if (!at) throw std::runtime_error(std::string("no field ") + field);
  }
  return *at;
}
inline const Value::List& list(const Value& value, std::initializer_list<const char*> path) {
  return std::get<Value::List>(in(value, path).content);
}
inline std::string text(const Value& value, std::initializer_list<const char*> path) {
  return std::get<std::string>(in(value, path).content);
}
inline std::uint64_t count(const Value& value, std::initializer_list<const char*> path) {
  return std::get<std::uint64_t>(in(value, path).content);
}
inline double number(const Value& value) {
  return std::get<double>(value.content);
}

}  // namespace prehend::test
