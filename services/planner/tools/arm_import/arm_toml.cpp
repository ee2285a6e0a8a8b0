#include "services/planner/tools/arm_import/arm_toml.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "common/arm/collision.hpp"
#include "common/base/random.hpp"
#include "services/planner/tools/hand_import/hand_toml.hpp"

namespace prehend::planner {
namespace {

constexpr int postures_tried = 400;
constexpr double nearly_every = 0.95;  // of the postures

/// Within the limits, and a turn at most.
arm::Joints random_posture(const model::ArmModel& arm, Random& random) {
  arm::Joints q(static_cast<Eigen::Index>(arm.joints.size()));
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const model::ArmJoint& joint = arm.joints[i];
    q[static_cast<Eigen::Index>(i)] =
        random.uniform(std::max(joint.lower, std::min(-std::numbers::pi, joint.upper - 0.1)),
                       std::min(joint.upper, std::max(std::numbers::pi, joint.lower + 0.1)));
  }
  return q;
}

}  // namespace

std::string write_toml(const ArmText& text) {
  const Eigen::Vector3d p = text.X_LE.translation();
  const Eigen::Quaterniond q(text.X_LE.linear());
  std::string out = fmt::format(
      "# Made by `prehend arm add`; models/arms/README.md says what each key means.\nname = {}\n",
      toml_text(text.name));
  if (text.home.size() > 0)
    out += fmt::format("home = [{}]\n", fmt::join(text.home.begin(), text.home.end(), ", "));
  out += fmt::format("\n[end]\nposition = [{}, {}, {}]\norientation = [{}, {}, {}, {}]\n", p.x(),
                     p.y(), p.z(), q.w(), q.x(), q.y(), q.z());
  if (text.not_checked.empty()) return out;
  out += "\n[collision]\nnot_checked = [\n";
  for (const auto& [a, b] : text.not_checked)
    out += fmt::format("  [{}, {}],\n", toml_text(a), toml_text(b));
  return out + "]\n";
}

std::vector<std::pair<std::string, std::string>> always_touching(const model::ArmModel& arm) {
  const arm::Collision collision(arm, {});
  Random random(1);
  std::map<std::pair<int, int>, int> touches;
  for (int k = 0; k < postures_tried; ++k) {
    std::map<std::pair<int, int>, bool> now;
    for (const auto& pair : collision.near(arm::forward(arm, random_posture(arm, random)), 0))
      now[std::minmax(pair.first, pair.second)] = true;
    for (const auto& [pair, is] : now) touches[pair] += is ? 1 : 0;
  }
  std::vector<std::pair<std::string, std::string>> found;
  for (const auto& [pair, count] : touches)
    if (count > nearly_every * postures_tried)
      found.emplace_back(arm.links[static_cast<std::size_t>(pair.first)].name,
                         arm.links[static_cast<std::size_t>(pair.second)].name);
  return found;
}

Eigen::VectorXd nimble_posture(const model::ArmModel& arm) {
  const arm::Collision collision(arm, {});
  Random random(2);
  Eigen::VectorXd best = arm.home;
  double most = -1;
  for (int k = 0; k < postures_tried; ++k) {
    const arm::Joints q = random_posture(arm, random);
    const arm::Configuration at = arm::forward(arm, q);
    if (at.X_AE.translation().z() < arm.X_AS.translation().z()) continue;
    const arm::Jacobian J = arm::jacobian(arm, at);
    const double freedom = (J * J.transpose()).determinant();
    if (freedom <= most || collision.clearance(at, 0.02) < 0.02) continue;
    most = freedom;
    best = q;
  }
  return best;
}

}  // namespace prehend::planner
