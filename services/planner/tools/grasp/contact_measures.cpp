#include "services/planner/tools/grasp/contact_measures.hpp"

#include "common/analysis/approach.hpp"
#include "common/analysis/contact_wrenches.hpp"
#include "common/analysis/grasp_map.hpp"
#include "common/analysis/grip_forces.hpp"
#include "common/analysis/resistance.hpp"
#include "services/planner/tools/planning/planning_task.hpp"

namespace prehend::planner {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The L∞ space and the linear programs grow faster than ε.
constexpr std::size_t max_contacts = 50;

Json forces_json(const Eigen::Matrix4Xd& forces) {
  Json list = Json::array();
  for (const auto& force : forces.colwise())
    list.push_back(Json{{"force_n", {force[0], force[1], force[2]}}, {"moment_nm", force[3]}});
  return list;
}

Expected<void> add_spaces(const GraspFile& grasp, Json& document) {
  std::vector<MatrixXd> by_contact;
  for (const analysis::Contact& contact : grasp.contacts)
    by_contact.push_back(analysis::edge_wrenches(contact, grasp.torque_scale, grasp.edges));
  const auto linf = analysis::linf_resistance(by_contact);
  if (!linf) return tl::unexpected(linf.error());
  document["epsilon_linf"] = linf->epsilon;
  const auto squeeze = analysis::best_squeeze(grasp.contacts, grasp.edges);
  if (!squeeze) return tl::unexpected(squeeze.error());
  document["squeeze_margin"] = *squeeze ? Json((*squeeze)->margin) : Json();
  return {};
}

/// The grip whose largest normal force is least, as if each contact had a drive along its normal.
Expected<void> add_grip(const GraspFile& grasp, Json& document) {
  const auto count = static_cast<Index>(grasp.contacts.size());
  MatrixXd normals = MatrixXd::Zero(4 * count, count);
  for (Index i = 0; i < count; ++i)
    normals.block<3, 1>(4 * i, i) = grasp.contacts[static_cast<std::size_t>(i)].normal_O;
  const auto grip = analysis::least_torques(grasp.contacts, *grasp.load_O, normals,
                                            VectorXd::Ones(count), grasp.edges);
  if (!grip) return tl::unexpected(grip.error());
  document["grip"] = *grip ? Json{{"largest_normal_force_n", (*grip)->effort},
                                  {"contacts", forces_json((*grip)->forces)}}
                           : Json();
  return {};
}

Expected<void> add_hand(const GraspFile& grasp, Json& document) {
  const auto hand = find_hand(grasp.hand->name);
  if (!hand) return tl::unexpected(hand.error());
  const auto jacobian = analysis::contact_jacobian(*hand, grasp.hand->joints,
                                                   grasp.hand->X_OB.inverse(), grasp.contacts);
  if (!jacobian) return tl::unexpected(jacobian.error());
  const analysis::Transmission moves = analysis::transmission(analysis::object_jacobian(
      grasp.contacts, grasp.torque_scale, *jacobian, analysis::coupling(*hand)));
  document["manipulability"] = moves.volume;
  document["manipulability_isotropy"] = moves.isotropy;
  if (!grasp.load_O) return {};
  VectorXd limits(jacobian->cols());
  for (Index i = 0; i < limits.size(); ++i)
    limits[i] = hand->joints()[static_cast<std::size_t>(i)].max_torque;
  const auto grip =
      analysis::least_torques(grasp.contacts, *grasp.load_O, *jacobian, limits, grasp.edges);
  if (!grip) return tl::unexpected(grip.error());
  if (!*grip) {
    document["least_torques"] = Json();
    return {};
  }
  const VectorXd& torques = (*grip)->torques;
  document["least_torques"] = {{"effort", (*grip)->effort},
                               {"torques", std::vector<double>(torques.begin(), torques.end())},
                               {"contacts", forces_json((*grip)->forces)}};
  return {};
}

}  // namespace

Expected<Json> contact_measures(const GraspFile& grasp) {
  Json document = Json::object();
  const auto map = analysis::transmission(analysis::grasp_map(grasp.contacts, grasp.torque_scale));
  document["isotropy"] = map.isotropy;
  document["smallest_singular_value"] = map.smallest;
  document["ellipsoid_volume"] = map.volume;
  document["internal_force_dimension"] =
      analysis::internal_force_dimension(grasp.contacts, grasp.torque_scale);
  if (grasp.approach_O && grasp.shape)
    document["skewness_rad"] = analysis::skewness(*grasp.shape, *grasp.approach_O);
  if (grasp.contacts.size() > max_contacts) return document;
  if (auto added = add_spaces(grasp, document); !added) return tl::unexpected(added.error());
  if (grasp.load_O)
    if (auto added = add_grip(grasp, document); !added) return tl::unexpected(added.error());
  if (grasp.hand)
    if (auto added = add_hand(grasp, document); !added) return tl::unexpected(added.error());
  return document;
}

}  // namespace prehend::planner
