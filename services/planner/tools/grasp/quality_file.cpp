#include "services/planner/tools/grasp/quality_file.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "common/analysis/contact_wrenches.hpp"
#include "common/base/file_text.hpp"

namespace prehend::planner {
namespace {

using Eigen::Vector3d;

constexpr std::size_t max_wrenches = 100000;
constexpr std::size_t max_contacts_of_a_file = 10000;
constexpr std::size_t max_joints = 100;

/// A finite number, or nothing.
std::optional<double> read_number(const nlohmann::json& json) {
  if (!json.is_number()) return std::nullopt;
  const double value = json.get<double>();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// `count` finite numbers into values; false when they are not.
bool read_numbers(const nlohmann::json& json, double* values, std::size_t count) {
  if (!json.is_array() || json.size() != count) return false;
  for (std::size_t i = 0; i < count; ++i) {
    const auto value = read_number(json[i]);
    if (!value) return false;
    values[i] = *value;
  }
  return true;
}

/// The same for a key that may be missing.
template <int N>
Expected<std::optional<Eigen::Matrix<double, N, 1>>> read_optional(const nlohmann::json& root,
                                                                   const std::string& key) {
  if (!root.contains(key)) return std::nullopt;
  Eigen::Matrix<double, N, 1> values;
  if (!read_numbers(root[key], values.data(), N))
    return fail("\"" + key + "\" is not " + std::to_string(N) + " finite numbers");
  return values;
}

Expected<Eigen::MatrixXd> read_wrenches(const nlohmann::json& list) {
  if (!list.is_array() || list.size() > max_wrenches)
    return fail("\"wrenches\" must be a list of at most " + std::to_string(max_wrenches));
  Eigen::MatrixXd wrenches(6, static_cast<Eigen::Index>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i)
    if (!read_numbers(list[i], wrenches.col(static_cast<Eigen::Index>(i)).data(), 6))
      return fail("wrench " + std::to_string(i) + " is not six finite numbers");
  return wrenches;
}

Expected<analysis::Contact> read_contact(const nlohmann::json& entry, const std::string& where) {
  if (!entry.is_object()) return fail("is no object", where);
  analysis::Contact contact;
  if (!read_numbers(entry.value("position_m", nlohmann::json()), contact.p_OC.data(), 3))
    return fail("\"position_m\" is not three finite numbers", where);
  if (!read_numbers(entry.value("normal", nlohmann::json()), contact.normal_O.data(), 3) ||
      !(contact.normal_O.norm() > 1e-9) || !std::isfinite(contact.normal_O.norm()))
    return fail("\"normal\" is not three finite numbers of some length", where);
  contact.normal_O.normalize();
  const auto friction = read_number(entry.value("friction", nlohmann::json()));
  if (!friction || *friction < 0) return fail("\"friction\" must be 0 or more", where);
  contact.friction = *friction;
  const auto torsion = read_number(entry.value("torsion_m", nlohmann::json(0)));
  if (!torsion || *torsion < 0) return fail("\"torsion_m\" must be 0 or more", where);
  contact.torsion = *torsion;
  if (entry.contains("tangent") && !read_numbers(entry["tangent"], contact.tangent_O.data(), 3))
    return fail("\"tangent\" is not three finite numbers", where);
  if (entry.value("link", nlohmann::json()).is_string())
    contact.link = entry["link"].get<std::string>();
  return contact;
}

Expected<model::Shape> read_shape(const nlohmann::json& json) {
  model::Shape shape;
  if (json.is_object() && json.value("kind", nlohmann::json()).is_string())
    shape.kind = model::shape_from_string(json["kind"].get<std::string>())
                     .value_or(model::ShapeKind::unknown);
  if (!json.is_object() ||
      !read_numbers(json.value("size_m", nlohmann::json()), shape.size.data(), 3) ||
      !model::is_valid(shape))
    return fail("\"shape\" needs a kind (cylinder, box, sphere, cone) and a positive size_m", {},
                "cylinder: radius, radius, height; sphere: the radius three times");
  return shape;
}

/// Where the hand is, when the file says so; center: of mass, in the file's frame.
Expected<std::optional<HandPlace>> read_hand(const nlohmann::json& root, const Vector3d& center) {
  if (!root.contains("hand") || !root.contains("joints") || !root.contains("X_OB"))
    return std::nullopt;
  const nlohmann::json& joints = root["joints"];
  const nlohmann::json& pose = root["X_OB"];
  HandPlace place;
  Vector3d p;
  Eigen::Vector4d q;
  if (!root["hand"].is_string() || !joints.is_array() || joints.size() > max_joints ||
      !pose.is_object() || !read_numbers(pose.value("position_m", nlohmann::json()), p.data(), 3) ||
      !read_numbers(pose.value("orientation_wxyz", nlohmann::json()), q.data(), 4))
    return fail("\"hand\" needs a name, \"joints\" and \"X_OB\"", {},
                "as prehend grasp export --index writes them");
  place.name = root["hand"].get<std::string>();
  place.joints.resize(static_cast<Eigen::Index>(joints.size()));
  if (!read_numbers(joints, place.joints.data(), joints.size()))
    return fail("\"joints\" are not finite numbers");
  const auto X_OB = checked_pose(p - center, Eigen::Quaterniond(q[0], q[1], q[2], q[3]));
  if (!X_OB) return tl::unexpected(X_OB.error());
  place.X_OB = *X_OB;
  return place;
}

Expected<GraspFile> from_contacts(const nlohmann::json& root) {
  const nlohmann::json& list = root["contacts"];
  if (!list.is_array() || list.size() > max_contacts_of_a_file)
    return fail("\"contacts\" must be a list of at most " + std::to_string(max_contacts_of_a_file));
  GraspFile grasp;
  const auto center = read_optional<3>(root, "center_of_mass_m");
  if (!center) return tl::unexpected(center.error());
  const auto scale = read_number(root.value("torque_scale_m", nlohmann::json()));
  if (!scale || !(*scale > 0))
    return fail("\"torque_scale_m\" must be a positive number", {},
                "the largest distance of the object's surface from its centre of mass");
  grasp.torque_scale = *scale;
  const nlohmann::json edges = root.value("edges", nlohmann::json(8));
  if (!edges.is_number_integer() || edges.get<std::int64_t>() < 3 || edges.get<std::int64_t>() > 64)
    return fail("\"edges\" must be 3 to 64");
  grasp.edges = edges.get<int>();
  for (const nlohmann::json& entry : list) {
    auto contact = read_contact(entry, "contact " + std::to_string(grasp.contacts.size()));
    if (!contact) return tl::unexpected(contact.error());
    if (*center) contact->p_OC -= **center;
    grasp.contacts.push_back(std::move(*contact));
  }
  const auto load = read_optional<6>(root, "load");
  if (!load) return tl::unexpected(load.error());
  grasp.load_O = *load;
  const auto approach = read_optional<3>(root, "approach");
  if (!approach) return tl::unexpected(approach.error());
  if (*approach && !((*approach)->norm() > 1e-9)) return fail("\"approach\" needs a length");
  grasp.approach_O = *approach;
  if (root.contains("shape")) {
    const auto shape = read_shape(root["shape"]);
    if (!shape) return tl::unexpected(shape.error());
    grasp.shape = *shape;
  }
  auto hand = read_hand(root, center->value_or(Vector3d::Zero()));
  if (!hand) return tl::unexpected(hand.error());
  grasp.hand = std::move(*hand);
  if (root.contains("wrenches")) {
    auto wrenches = read_wrenches(root["wrenches"]);
    if (!wrenches) return tl::unexpected(wrenches.error());
    grasp.wrenches = std::move(*wrenches);
    return grasp;
  }
  grasp.wrenches = analysis::contact_wrenches(grasp.contacts, grasp.torque_scale, grasp.edges);
  if (!grasp.wrenches.allFinite()) return fail("the numbers are too large");
  return grasp;
}

Expected<GraspFile> from_wrenches(const nlohmann::json& root) {
  auto wrenches = read_wrenches(root["wrenches"]);
  if (!wrenches) return tl::unexpected(wrenches.error());
  GraspFile grasp;
  grasp.wrenches = std::move(*wrenches);
  return grasp;
}

}  // namespace

Expected<GraspFile> read_grasp(const std::filesystem::path& file) {
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  const nlohmann::json root = nlohmann::json::parse(*text, nullptr, false);
  if (root.is_discarded() || !root.is_object())
    return fail("is no JSON object", file.string(), "see prehend grasp quality --help");
  auto grasp = root.contains("contacts")   ? from_contacts(root)
               : root.contains("wrenches") ? from_wrenches(root)
                                           : fail("has neither contacts nor wrenches");
  if (!grasp) {
    Error error = grasp.error();
    error.where = file.string() + (error.where.empty() ? "" : ": " + error.where);
    return tl::unexpected(std::move(error));
  }
  return grasp;
}

}  // namespace prehend::planner
