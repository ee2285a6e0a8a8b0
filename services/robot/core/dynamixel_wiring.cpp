#include "services/robot/core/dynamixel_wiring.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "common/base/toml_document.hpp"
#include "common/model/toml_values.hpp"
#include "services/robot/core/dynamixel_protocol.hpp"

namespace prehend::robot::dynamixel {
namespace {

constexpr const char* page = "see services/robot/README.md";

/// What is true of all servos.
struct Kind {
  double torque_per_ampere = 0, current_unit = 1, max_current = 0;
};

Expected<Kind> kind_in(const toml::table& root) {
  const auto table = model::table_of(root, "servos");
  if (!table) return tl::unexpected(table.error());
  if (auto known = model::only_keys(*table, {"torque_per_ampere", "current_unit", "max_current"},
                                    "servos", page);
      !known)
    return tl::unexpected(known.error());
  Kind kind;
  for (const auto& [key, value, otherwise] :
       {std::tuple{"torque_per_ampere", &kind.torque_per_ampere, 0.0},
        std::tuple{"current_unit", &kind.current_unit, 1.0},
        std::tuple{"max_current", &kind.max_current, 0.0}}) {
    const auto read = model::number_or(*table, key, otherwise, std::string("servos.") + key);
    if (!read) return tl::unexpected(read.error());
    if (!(*read > 0)) return fail("must be positive", std::string("servos.") + key, page);
    *value = *read;
  }
  return kind;
}

/// A whole number in a range.
Expected<int> whole(const toml::table& table, std::string_view key, int lower, int upper,
                    const std::string& where) {
  const auto value = model::number_or(table, key, std::nan(""), where);
  if (!value) return tl::unexpected(value.error());
  if (!(*value >= lower && *value <= upper) || *value != std::floor(*value))
    return fail(
        "must be a whole number from " + std::to_string(lower) + " to " + std::to_string(upper),
        where + "." + std::string(key), page);
  return static_cast<int>(*value);
}

Expected<Servo> servo_in(const toml::table& table, const Kind& kind, const model::HandModel& hand) {
  if (auto known = model::only_keys(table, {"id", "dof", "zero", "ratio"}, "servo", page); !known)
    return tl::unexpected(known.error());
  const auto name = model::text_of(table, "dof", "servo");
  if (!name) return tl::unexpected(name.error());
  const std::string where = "servo of " + *name;
  const int dof = model::find_named(hand.dofs(), *name);
  if (dof < 0) return fail("the hand " + hand.name() + " has no such DoF", where, page);
  const auto id = whole(table, "id", 0, last_id, where);
  if (!id) return tl::unexpected(id.error());
  const auto zero = whole(table, "zero", -max_pulses, max_pulses, where);
  if (!zero) return tl::unexpected(zero.error());
  const auto ratio = model::number_or(table, "ratio", 1, where);
  if (!ratio) return tl::unexpected(ratio.error());
  if (*ratio == 0) return fail("must not be 0", where + ".ratio", page);
  Servo servo;
  servo.id = static_cast<std::uint8_t>(*id);
  servo.dof = static_cast<std::size_t>(dof);
  servo.zero = *zero;
  servo.pulses = *ratio * pulses_per_turn / (2 * std::numbers::pi);
  servo.current = 1000 / (kind.torque_per_ampere * std::abs(*ratio) * kind.current_unit);
  servo.max_current = static_cast<int>(std::min(kind.max_current / kind.current_unit, 32767.0));
  const model::HandDof& range = hand.dofs()[servo.dof];
  for (const double end : {range.lower, range.upper})
    if (!(std::abs(servo.position_of(end)) <= max_pulses))
      return fail("would turn too often for its range", where, page);
  return servo;
}

}  // namespace

Expected<std::vector<Servo>> parse_wiring(std::string_view toml, const model::HandModel& hand,
                                          const std::string& file) {
  const auto root = parse_toml(toml, file);
  if (!root) return tl::unexpected(root.error());
  const auto at = [&](const Error& error) { return tl::unexpected(model::located(error, file)); };
  if (auto known = model::only_keys(*root, {"servos", "servo"}, "", page); !known)
    return at(known.error());
  const auto kind = kind_in(*root);
  if (!kind) return at(kind.error());
  const auto entries = model::entries(*root, "servo");
  if (!entries) return at(entries.error());
  std::vector<Servo> servos;
  for (const toml::table* entry : *entries) {
    const auto servo = servo_in(*entry, *kind, hand);
    if (!servo) return at(servo.error());
    for (const Servo& other : servos)
      if (other.id == servo->id || other.dof == servo->dof)
        return at({"two servos have the same id or the same dof",
                   "servo " + std::to_string(servo->id), page});
    servos.push_back(*servo);
  }
  std::sort(servos.begin(), servos.end(),
            [](const Servo& a, const Servo& b) { return a.dof < b.dof; });
  if (servos.size() != hand.dofs().size())
    return at({"not every DoF of the hand " + hand.name() + " has a servo", "servo", page});
  return servos;
}

}  // namespace prehend::robot::dynamixel
