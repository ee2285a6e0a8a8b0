#include "services/recorder/tools/recording/table.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace prehend::recorder {
namespace {

using namespace recording::types;

/// Calls take(column, value) for every column; the value is null where only names are asked for.
template <class Take>
void walk(const Structure& type, const Value* message, const std::string& prefix,
          const Take& take) {
  for (std::size_t i = 0; i < type.fields.size(); ++i) {
    const Field& field = type.fields[i];
    const Value* value = message ? &std::get<Value::Fields>(message->content)[i].value : nullptr;
    const std::string name = prefix + field.name;
    const auto take_one = [&](const std::string& column, const Value* one) {
      if (field.type.structure)
        walk(*field.type.structure, one, column + ".", take);
      else
        take(column, one);
    };
    // Octets are one value, however many they are.
    if (field.type.many == Type::Many::one) {
      take_one(name, value);
    } else if (field.type.many == Type::Many::sequence || field.type.kind == Kind::uint8) {
      take(name, value);
    } else {
      const auto* list = value ? &std::get<Value::List>(value->content) : nullptr;
      for (std::size_t k = 0; k < field.type.count; ++k)
        take_one(fmt::format("{}[{}]", name, k), list ? &(*list)[k] : nullptr);
    }
  }
}

std::string cell(const Value& value) {
  if (const auto* number = std::get_if<double>(&value.content)) return fmt::format("{}", *number);
  const auto json = to_json(value);
  std::string text = json.is_string() ? json.get<std::string>()
                                      : json.dump(-1, ' ', false,
                                                  nlohmann::ordered_json::error_handler_t::replace);
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::vector<std::string> columns(const Structure& type) {
  std::vector<std::string> names;
  walk(type, nullptr, "", [&](const std::string& name, const Value*) { names.push_back(name); });
  return names;
}

std::vector<std::string> cells(const Structure& type, const Value& message) {
  std::vector<std::string> row;
  walk(type, &message, "",
       [&](const std::string&, const Value* value) { row.push_back(cell(*value)); });
  return row;
}

}  // namespace prehend::recorder
