#include "services/planner/tools/planning/export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/analysis/wrench_space.hpp"

namespace prehend::planner {
namespace {

using Json = nlohmann::ordered_json;
using grasping::Plan;
using grasping::PlannedGrasp;

template <class Values>
Json list(const Values& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

Json pose(const Pose& X) {
  const Eigen::Vector3d p = X.translation();
  const Eigen::Quaterniond q(X.linear());
  return {{"position_m", list(p)}, {"orientation_wxyz", {q.w(), q.x(), q.y(), q.z()}}};
}

Json phase(const std::optional<bool>& survived) {
  return survived ? Json(*survived) : Json();
}

Json hold_json(const grasping::HoldResult& hold) {
  return {
      {"held", hold.held},          {"lift", phase(hold.lift)},
      {"shake", phase(hold.shake)}, {"turned_over", phase(hold.turned_over)},
      {"slip_m", hold.slip},        {"turn_rad", hold.turn},
      {"drift_m_s", hold.drift},    {"reason", hold.reason.empty() ? Json() : Json(hold.reason)}};
}

std::string quoted(std::string text) {
  for (std::size_t at = 0; (at = text.find('"', at)) != std::string::npos; at += 2)
    text.insert(at, 1, '"');
  return '"' + text + '"';
}

template <class Values>
std::string row(const Values& values) {
  return fmt::format("{}", fmt::join(values.data(), values.data() + values.size(), ","));
}

}  // namespace

Json to_json(const Plan& plan, const PlannedGrasp& grasp) {
  Json contacts = Json::array(), wrenches = Json::array();
  for (const analysis::Contact& contact : grasp.contacts)
    contacts.push_back({{"link", contact.link},
                        {"position_m", list(contact.p_OC)},
                        {"normal", list(contact.normal_O)},
                        {"friction", contact.friction},
                        {"torsion_m", contact.torsion},
                        {"force_n", contact.force},
                        {"depth_m", contact.depth}});
  for (Eigen::Index i = 0; i < grasp.wrenches.cols(); ++i)
    wrenches.push_back(list(grasp.wrenches.col(i)));
  return {{"hand", plan.hand},
          {"object", plan.object.name},
          {"candidate", grasp.candidate},
          {"posture", grasp.posture},
          {"preshape", list(grasp.preshape)},
          {"X_OB_before", pose(grasp.X_OB_before)},
          {"X_OB", pose(grasp.X_OB)},
          {"dof", list(grasp.dof)},
          {"joints", list(grasp.joints)},
          {"epsilon", grasp.quality.epsilon},
          {"volume", grasp.quality.volume},
          {"force_closure", grasp.quality.force_closure},
          {"weakest_direction", list(grasp.quality.weakest_direction)},
          {"hold", hold_json(grasp.hold)},
          {"center_of_mass_m", list(grasping::centre_of_mass(plan.object))},
          {"torque_scale_m", grasping::torque_scale(plan.object)},
          {"edges", 8},  // of each ring, as contact_wrenches() makes them
          {"contacts", contacts},
          {"wrenches", wrenches}};
}

Json summary_json(const Plan& plan) {
  const model::Shape& shape = plan.object.shape;
  Json refused = Json::object();
  for (const auto& [reason, count] : plan.refused) refused[reason] = count;
  return {{"hand", plan.hand},
          {"object",
           {{"name", plan.object.name},
            {"shape", model::to_string(shape.kind)},
            {"size_m", list(shape.size)},
            {"mass_kg", plan.object.mass},
            {"material", plan.object.material}}},
          {"seed", plan.options.seed},
          {"candidates", plan.options.candidates},
          {"table", plan.options.table},
          {"closed", plan.closed},
          {"refused", refused},
          {"held", plan.held()},
          {"reason", plan.reason.empty() ? Json() : Json(plan.reason)}};
}

std::string to_csv(const Plan& plan, Table table) {
  std::string text;
  const auto line = [&](const std::string& what) { text += what + "\n"; };
  switch (table) {
    case Table::grasps:
      line("grasp,candidate,epsilon,volume,held,slip_m,turn_rad,x_m,y_m,z_m,qw,qx,qy,qz,reason");
      break;
    case Table::contacts:
      line("grasp,link,x_m,y_m,z_m,nx,ny,nz,friction,force_n,depth_m,torsion_m");
      break;
    case Table::wrenches:
      line("grasp,fx,fy,fz,tx,ty,tz");
      break;
    case Table::dof:
      line("grasp,dof,preshape,closed");
      break;
  }
  for (std::size_t g = 0; g < plan.grasps.size(); ++g) {
    const PlannedGrasp& grasp = plan.grasps[g];
    if (table == Table::grasps) {
      const Eigen::Vector3d p = grasp.X_OB.translation();
      const Eigen::Quaterniond q(grasp.X_OB.linear());
      line(fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}", g, grasp.candidate,
                       grasp.quality.epsilon, grasp.quality.volume, grasp.hold.held ? 1 : 0,
                       grasp.hold.slip, grasp.hold.turn, row(p), q.w(), q.x(), q.y(), q.z(),
                       quoted(grasp.hold.reason)));
    } else if (table == Table::contacts) {
      for (const analysis::Contact& contact : grasp.contacts)
        line(fmt::format("{},{},{},{},{},{},{},{}", g, quoted(contact.link), row(contact.p_OC),
                         row(contact.normal_O), contact.friction, contact.force, contact.depth,
                         contact.torsion));
    } else if (table == Table::wrenches) {
      for (Eigen::Index i = 0; i < grasp.wrenches.cols(); ++i)
        line(fmt::format("{},{}", g, row(grasp.wrenches.col(i))));
    } else {
      for (Eigen::Index i = 0; i < grasp.dof.size(); ++i)
        line(fmt::format("{},{},{},{}", g, i, grasp.preshape[i], grasp.dof[i]));
    }
  }
  return text;
}

}  // namespace prehend::planner
