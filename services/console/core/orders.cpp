#include "services/console/core/orders.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace prehend::console {
namespace {

constexpr std::size_t max_argument = 127;  // of the contract
constexpr double off_table = 2;            // m, from the table's middle

struct Row {
  std::string_view action;
  OrderKind kind;
  std::string_view target;
  bool needs_argument;
};
constexpr Row rows[]{
    {"stop", OrderKind::stop, "gate", false},
    {"release", OrderKind::release, "gate", true},
    {"record", OrderKind::start, "recorder", true},
    {"replay", OrderKind::start, "replayer", true},
    {"mode", OrderKind::set_mode, "mapping", true},
    {"show", OrderKind::start, "demonstration", true},
    {"shown", OrderKind::stop, "demonstration", false},
    {"lead", OrderKind::take_over, "", true},
    {"place", OrderKind::place, "simulation", true},
};

}  // namespace

Expected<Order> read_order(std::string_view body) {
  const auto wrong = [](const char* what) { return wrong_use(what, "order"); };
  const auto asked = nlohmann::json::parse(body, nullptr, false);
  if (!asked.is_object()) return wrong("is no JSON object");
  const auto text = [&](const char* name) -> std::string {
    const auto found = asked.find(name);
    return found != asked.end() && found->is_string() ? found->get<std::string>() : "";
  };
  const std::string action = text("action"), argument = text("argument");
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
  return wrong("is none of stop, release, record, replay, mode, show, shown, lead, place");
}

}  // namespace prehend::console
