#include "services/console/core/orders.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

namespace prehend::console {
namespace {

constexpr std::size_t max_argument = 127;  // of the contract
constexpr double off_table = 2;            // m, from the table's middle

struct Row {
  std::string_view action;
  OrderKind kind;
  std::string_view target;
  bool needs_argument;
  std::string_view meaning;  // of the argument
};
constexpr Row rows[]{
    {"stop", OrderKind::stop, "gate", false, "why"},
    {"release", OrderKind::release, "gate", true, "why it is safe"},
    {"record", OrderKind::start, "recorder", true, "start, pause, snapshot, stop"},
    {"replay", OrderKind::start, "replayer", true, "pause, resume, step, rate R, seek S, stop"},
    {"mode", OrderKind::set_mode, "mapping", true,
     "words: joints, cartesian, combined, retargeting; direct, intelligent; placement, "
     "no-placement"},
    {"show", OrderKind::start, "demonstration", true, "a task's name"},
    {"shown", OrderKind::stop, "demonstration", false, "the task's name, or nothing"},
    {"lead", OrderKind::take_over, "", true, "a service, as mapping@host/1"},
    {"place", OrderKind::place, "simulation", true, "an object of the catalogue"},
    {"teach", OrderKind::teach, "teacher", true, "show NAME, again, end, train NAME"},
};

tl::unexpected<Error> wrong(const char* what) {
  return wrong_use(what, "order");
}

std::string text_in(const nlohmann::json& asked, const char* name) {
  const auto found = asked.find(name);
  return found != asked.end() && found->is_string() ? found->get<std::string>() : "";
}

Expected<Order> order_from(std::string_view action, const nlohmann::json& asked) {
  const std::string argument = text_in(asked, "argument");
  if (argument.size() > max_argument) return wrong("has an argument that is too long");
  if (std::any_of(argument.begin(), argument.end(),
                  [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
    return wrong("has an argument that is not printable");
  for (const Row& row : rows) {
    if (row.action != action) continue;
    if (row.needs_argument && argument.empty()) return wrong("needs an argument");
    Order made{row.kind, std::string(row.target), argument};
    if (row.kind != OrderKind::place) return made;
    const auto x = asked.find("x"), y = asked.find("y");
    if (x == asked.end() || y == asked.end() || !x->is_number() || !y->is_number())
      return wrong("says not where: x and y, m");
    made.x = x->get<double>();
    made.y = y->get<double>();
    if (!(std::hypot(made.x, made.y) <= off_table)) return wrong("is for a place beside the table");
    return made;
  }
  return wrong("is none of stop, release, record, replay, mode, show, shown, lead, place, teach");
}

}  // namespace

Expected<Order> read_order(std::string_view body) {
  const auto asked = nlohmann::json::parse(body, nullptr, false);
  if (!asked.is_object()) return wrong("is no JSON object");
  return order_from(text_in(asked, "action"), asked);
}

Expected<Order> read_order(std::string_view action, std::string_view request) {
  const auto asked = nlohmann::json::parse(request, nullptr, false);
  if (!asked.is_object()) return wrong("is no JSON object");
  return order_from(action, asked);
}

std::vector<ServiceInfo> services_for_orders() {
  using Json = nlohmann::ordered_json;
  const auto schema = [](Json properties, Json required) {
    return Json{{"type", "object"},
                {"properties", std::move(properties)},
                {"required", std::move(required)}}
        .dump();
  };
  const auto type = [](const char* name) { return Json{{"type", name}}; };
  const std::string answer = schema({{"service", type("string")}, {"message", type("string")}},
                                    Json::array({"service", "message"}));
  std::vector<ServiceInfo> made;
  for (const Row& row : rows) {
    Json properties{{"argument", {{"type", "string"}, {"description", row.meaning}}}};
    Json required = Json::array();
    if (row.needs_argument) required.push_back("argument");
    if (row.kind == OrderKind::place)
      for (const char* name : {"x", "y"}) {
        properties[name] = {{"type", "number"}, {"description", "m, on the table"}};
        required.push_back(name);
      }
    made.push_back({0, std::string(order_services) + std::string(row.action),
                    schema(std::move(properties), std::move(required)), answer});
  }
  made.push_back({0, std::string(order_services) + "consent",
                  schema({{"hand", type("string")},
                          {"held", type("boolean")},
                          {"now_ms", {{"type", "integer"}, {"description", "of the last answer"}}}},
                         Json::array({"hand", "held"})),
                  schema({{"now_ms", type("integer")}}, Json::array({"now_ms"}))});
  return made;
}

}  // namespace prehend::console
