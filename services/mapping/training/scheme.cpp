#include "scheme.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <numbers>

namespace prehend::mapping {

namespace {

/// `count` numbers of an array; empty when they are not that.
std::vector<double> numbers(const toml::node_view<const toml::node>& node, std::size_t count) {
  std::vector<double> values;
  if (const toml::array* array = node.as_array())
    for (const toml::node& element : *array)
      if (const auto value = element.value<double>()) values.push_back(*value);
  if (values.size() != count || node.as_array()->size() != count) values.clear();
  return values;
}

Expected<Eigen::VectorXd> robot_posture(const toml::table& table, const model::HandModel& hand) {
  const std::size_t count = hand.dofs().size();
  const std::vector<double> degrees = numbers(table["robot"], count);
  if (degrees.size() != count) return fail(fmt::format("«robot» is not {} numbers", count));
  const Eigen::VectorXd dof =
      Eigen::VectorXd::Map(degrees.data(), static_cast<int>(count)) * (std::numbers::pi / 180);
  if (!dof.allFinite() || !hand.clamp(dof).isApprox(dof, 1e-9))
    return fail("«robot» is outside the hand's limits");
  return dof;
}

}  // namespace

Expected<Scheme> Scheme::load(const std::filesystem::path& file, const model::HandModel& hand) {
  const auto refuse = [&](const std::string& what, const std::string& element = {}) {
    return fail(what, element.empty() ? file.string() : file.string() + ", " + element);
  };
  toml::table table;
  try {
    table = toml::parse_file(file.string());
  } catch (const toml::parse_error& error) {
    return refuse(std::string(error.description()));
  }
  if (table["hand"].value_or(std::string()) != hand.name())
    return refuse(fmt::format("is not for the hand «{}»", hand.name()));

  Scheme scheme;
  scheme.name = table["name"].value_or(std::string());
  if (const toml::array* postures = table["posture"].as_array())
    for (const toml::node& node : *postures) {
      const toml::table* entry = node.as_table();
      if (!entry) return refuse("a posture is not a table");
      SchemePosture posture;
      posture.name = (*entry)["name"].value_or(std::string());
      const auto closure = numbers((*entry)["human"], model::finger_count);
      if (closure.empty()) return refuse("«human» is not five numbers", posture.name);
      for (std::size_t f = 0; f < closure.size(); ++f) {
        if (!(closure[f] >= 0 && closure[f] <= 1))
          return refuse("«human» is outside 0 to 1", posture.name);
        posture.human[f] = closure[f];
      }
      auto robot = robot_posture(*entry, hand);
      if (!robot) return refuse(robot.error().what, posture.name);
      posture.robot = std::move(*robot);
      scheme.postures.push_back(std::move(posture));
    }
  if (const toml::array* preshapes = table["preshape"].as_array())
    for (const toml::node& node : *preshapes) {
      const toml::table* entry = node.as_table();
      if (!entry) return refuse("a preshape is not a table");
      auto robot = robot_posture(*entry, hand);
      if (!robot) return refuse(robot.error().what, "preshape");
      scheme.preshapes.push_back(std::move(*robot));
    }
  if (scheme.postures.size() < 2) return refuse("has fewer than two postures");
  if (scheme.preshapes.empty()) return refuse("has no preshape");
  return scheme;
}

}  // namespace prehend::mapping
