#include "common/recording/messages/json_message.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

namespace prehend::recording {
namespace {

using Json = nlohmann::json;
using types::Value;

constexpr int max_depth = 64;

class Reader {
 public:
  explicit Reader(Names& names) : names_(names) {}

  Value value(const Json& json) {
    switch (json.type()) {
      case Json::value_t::object: {
        Value::Fields fields;
        for (const auto& [name, each] : json.items())
          if (!each.is_null()) fields.push_back({*names_.insert(name).first, value(each)});
        return {std::move(fields)};
      }
      case Json::value_t::array: {
        Value::List list;
        for (const Json& each : json) list.push_back(value(each));
        return {std::move(list)};
      }
      case Json::value_t::boolean:
        return {json.get<bool>()};
      case Json::value_t::number_integer:
        return {json.get<std::int64_t>()};
      case Json::value_t::number_unsigned:
        return {json.get<std::uint64_t>()};
      case Json::value_t::number_float:
        return {json.get<double>()};
      case Json::value_t::string:
        return {json.get<std::string>()};
      default:
        return {std::string()};
    }
  }

 private:
  Names& names_;
};

}  // namespace

Expected<Value> json_message(std::span<const std::uint8_t> message, Names& names) {
  int deepest = 0;
  const auto watch = [&](int depth, Json::parse_event_t, const Json&) {
    deepest = std::max(deepest, depth);
    return depth <= max_depth;
  };
  const Json json = Json::parse(message.begin(), message.end(), watch, false);
  if (deepest > max_depth) return fail("its JSON lies too deep inside itself");
  if (json.is_discarded()) return fail("it is no JSON");
  if (!json.is_object()) return fail("its JSON is no object");
  return Reader(names).value(json);
}

}  // namespace prehend::recording
