#include "quality_file.hpp"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <prehend/analysis/wrench_space.hpp>
#include <string>
#include <vector>

namespace prehend::simulation {
namespace {

using Json = nlohmann::json;
using Eigen::Vector3d;

constexpr std::size_t most_wrenches = 20000;
constexpr std::size_t most_contacts = 1000;

/// `count` finite numbers, or nothing.
bool read_numbers(const Json& json, double* values, std::size_t count) {
  if (!json.is_array() || json.size() != count) return false;
  for (std::size_t i = 0; i < count; ++i) {
    if (!json[i].is_number()) return false;
    values[i] = json[i].get<double>();
    if (!std::isfinite(values[i])) return false;
  }
  return true;
}

Expected<Eigen::MatrixXd> from_wrenches(const Json& list) {
  if (!list.is_array() || list.size() > most_wrenches)
    return fail("\"wrenches\" must be a list of at most 20000");
  Eigen::MatrixXd wrenches(6, static_cast<Eigen::Index>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i)
    if (!read_numbers(list[i], wrenches.col(static_cast<Eigen::Index>(i)).data(), 6))
      return fail("wrench " + std::to_string(i) + " is not six finite numbers");
  return wrenches;
}

Expected<Eigen::MatrixXd> from_contacts(const Json& root) {
  const Json& list = root["contacts"];
  if (!list.is_array() || list.size() > most_contacts)
    return fail("\"contacts\" must be a list of at most 1000");
  Vector3d center = Vector3d::Zero();
  if (root.contains("center_of_mass_m") &&
      !read_numbers(root["center_of_mass_m"], center.data(), 3))
    return fail("\"center_of_mass_m\" is not three finite numbers");
  const Json scale = root.value("torque_scale_m", Json());
  if (!scale.is_number() || !(scale.get<double>() > 0) || !std::isfinite(scale.get<double>()))
    return fail("\"torque_scale_m\" must be a positive number", {},
                "the largest distance of the object's surface from its centre of mass");
  const Json edges = root.value("edges", Json(8));
  if (!edges.is_number_integer() || edges.get<std::int64_t>() < 3 || edges.get<std::int64_t>() > 64)
    return fail("\"edges\" must be 3 to 64");
  std::vector<analysis::Contact> contacts;
  for (const Json& entry : list) {
    const std::string where = "contact " + std::to_string(contacts.size());
    if (!entry.is_object()) return fail("is no object", where);
    analysis::Contact contact;
    if (!read_numbers(entry.value("position_m", Json()), contact.p_OC.data(), 3))
      return fail("\"position_m\" is not three finite numbers", where);
    contact.p_OC -= center;
    if (!read_numbers(entry.value("normal", Json()), contact.normal_O.data(), 3) ||
        contact.normal_O.norm() < 1e-9)
      return fail("\"normal\" is not three finite numbers of some length", where);
    const Json friction = entry.value("friction", Json());
    if (!friction.is_number() || !(friction.get<double>() >= 0) ||
        !std::isfinite(friction.get<double>()))
      return fail("\"friction\" must be 0 or more", where);
    contact.friction = friction.get<double>();
    if (entry.contains("tangent") && !read_numbers(entry["tangent"], contact.tangent_O.data(), 3))
      return fail("\"tangent\" is not three finite numbers", where);
    contacts.push_back(std::move(contact));
  }
  return analysis::contact_wrenches(contacts, scale.get<double>(), edges.get<int>());
}

}  // namespace

Expected<Eigen::MatrixXd> read_wrenches(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) return fail("cannot be read", file.string());
  const Json root = Json::parse(stream, nullptr, false);
  if (root.is_discarded() || !root.is_object())
    return fail("is no JSON object", file.string(), "see prehend grasp quality --help");
  auto wrenches = root.contains("wrenches")   ? from_wrenches(root["wrenches"])
                  : root.contains("contacts") ? from_contacts(root)
                                              : fail("has neither contacts nor wrenches");
  if (!wrenches) {
    Error error = wrenches.error();
    error.where = file.string() + (error.where.empty() ? "" : ": " + error.where);
    return tl::unexpected(std::move(error));
  }
  return wrenches;
}

}  // namespace prehend::simulation
