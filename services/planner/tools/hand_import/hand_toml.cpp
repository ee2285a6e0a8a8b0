#include "services/planner/tools/hand_import/hand_toml.hpp"

#include <fmt/format.h>

#include "common/model/hand_coupling.hpp"

namespace prehend::planner {
namespace {

/// Numbers of a TOML array, with as many digits as measuring a hand can mean.
template <class Numbers>
std::string row(const Numbers& numbers) {
  std::string text;
  for (const double number : numbers)
    text += fmt::format("{}{:.9g}", text.empty() ? "" : ", ", number + 0.0);
  return "[" + text + "]";
}

/// A thumb that is as strong as a finger is pushed back by several, and nothing comes to rest.
std::string thumb_torques(const Anatomy& anatomy, const Robot& robot) {
  constexpr double stronger = 2.5;
  std::string text;
  for (const std::string& joint : anatomy.thumb_joints)
    text += fmt::format("{} = {:.4g}\n", toml_text(joint),
                        stronger * robot.find_joint(joint)->limit->effort);
  if (text.empty()) return text;
  return fmt::format(
      "# The thumb stands against several fingers: {} times the effort of one.\n[torque]\n{}\n",
      stronger, text);
}

/// A wrist is held where it rests: the arm moves the palm.
std::string wrist_limits(const Anatomy::Dof& dof, const Robot& robot) {
  const JointLimit& limit = *robot.find_joint(dof.joint)->limit;
  const double slack = 0.01 * (limit.upper - limit.lower);
  return fmt::format(
      "# a wrist: held still, since the arm moves the palm\nlower = {:.9g}\nupper = {:.9g}\n",
      std::max(limit.lower, dof.open - slack), std::min(limit.upper, dof.open + slack));
}

}  // namespace

std::string toml_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      quoted += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else if (c == '"' || c == '\\')
      (quoted += '\\') += c;
    else
      quoted += c;
  }
  return quoted + "\"";
}

std::string write_toml(const Anatomy& anatomy, const std::string& name, const Robot& robot) {
  const Eigen::Quaterniond q(anatomy.X_BG.linear());
  std::string text = fmt::format(
      "# Found by `prehend hand add` from the URDF; correct what it guessed wrong.\n"
      "# Frames: B the base, metres, radians.\nname = {}\n\n"
      "# z out of the palm, y from the thumb's side to the fingers'\n"
      "[grasp_frame]\nposition = {}\norientation = {}  # w, x, y, z\n\n"
      "[reach]\nopening = {:.4f}\nengage = {:.4f}\nclearance = {:.4f}\nhalf_width = {:.4f}\n",
      toml_text(name), row(anatomy.X_BG.translation()),
      row(std::vector<double>{q.w(), q.x(), q.y(), q.z()}), anatomy.reach.opening,
      anatomy.reach.engage, anatomy.reach.clearance, anatomy.reach.half_width);
  std::vector<double> open, fist;
  for (const Anatomy::Dof& dof : anatomy.dofs) {
    text += fmt::format("\n[[dof]]\nname = {0}\njoint = {0}\nclosing = {1}\n", toml_text(dof.joint),
                        dof.closing);
    if (dof.coupling != model::Coupling::springs)
      text += fmt::format("coupling = \"{}\"\n", model::coupling_names.name(dof.coupling));
    if (dof.wrist) text += wrist_limits(dof, robot);
    open.push_back(dof.open);
    fist.push_back(dof.fist);
  }
  for (const Anatomy::Fingertip& tip : anatomy.fingertips) {
    text += fmt::format("\n[[fingertip]]\nname = {}\nlink = {}\nposition = {}\n",
                        toml_text(tip.name), toml_text(tip.link), row(tip.p_LT));
    if (tip.human) text += fmt::format("human = \"{}\"\n", model::finger_names.name(*tip.human));
  }
  text += fmt::format(
      "\n# Torque limits are those of the URDF; [torque] overrides them.\n{}[materials]\n"
      "default = \"rubber\"\n{} = \"plastic\"\n\n[postures]\nopen = {}\nfist = {}\n",
      thumb_torques(anatomy, robot), toml_text(robot.links[0].name), row(open), row(fist));
  for (const auto& [posture, dof] : anatomy.preshapes)
    text += fmt::format("{} = {}\n", posture, row(dof));
  return text;
}

}  // namespace prehend::planner
