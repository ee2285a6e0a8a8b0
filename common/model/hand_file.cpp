// Reads hand.toml and joins it with what hand.urdf said to a HandModel.
#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "common/base/file_text.hpp"
#include "common/base/toml_document.hpp"
#include "common/model/hand_coupling.hpp"
#include "common/model/hand_effort.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/hand_urdf.hpp"
#include "common/model/toml_values.hpp"

namespace prehend::model {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double prismatic_squeeze =
    0.005;                            // m, for the full effort unless hand.toml says otherwise
constexpr double max_coupling = 1e4;  // rad/m of a gear rack of 0.1 mm
constexpr const char* hand_page = "see models/hands/README.md";
constexpr const char* parts = "a hand is hand.urdf and hand.toml";
constexpr double tolerance = 1e-3;  // rad or m, of limits and postures written by hand

}  // namespace

/// Fills a HandModel; the only one who changes it.
class HandLoader {
 public:
  explicit HandLoader(HandTree tree)
      : mimics_(std::move(tree.mimics)), velocities_(std::move(tree.velocities)) {
    hand.links_ = std::move(tree.links);
    hand.joints_ = std::move(tree.joints);
  }

  Expected<void> load(const toml::table& root) {
    if (auto known = only_keys(root,
                               {"name", "grasp_frame", "reach", "dof", "fingertip", "torque",
                                "breakaway", "materials", "postures", "gate"},
                               {}, hand_page);
        !known)
      return known;
    const auto name = text_of(root, "name", {});
    if (!name) return tl::unexpected(name.error());
    hand.name_ = *name;
    hand.mirror_name_ = mirror_name(*name);
    for (const auto& step :
         {&HandLoader::read_dofs, &HandLoader::couple, &HandLoader::read_torques,
          &HandLoader::read_breakaways, &HandLoader::read_materials, &HandLoader::read_fingertips,
          &HandLoader::read_grasp_frame, &HandLoader::read_reach, &HandLoader::read_postures,
          &HandLoader::read_gate})
      if (auto done = (this->*step)(root); !done) return done;
    return {};
  }

  HandModel hand;

 private:
  Expected<void> read_dofs(const toml::table& root) {
    const auto tables = entries(root, "dof");
    if (!tables) return tl::unexpected(tables.error());
    for (const toml::table* table : *tables) {
      auto dof = read_dof(*table);
      if (!dof) return tl::unexpected(dof.error());
      hand.dofs_.push_back(std::move(*dof));
    }
    return {};
  }

  Expected<HandDof> read_dof(const toml::table& table) {
    HandDof dof;
    const auto name = text_of(table, "name", "[[dof]]");
    if (!name) return tl::unexpected(name.error());
    dof.name = *name;
    const std::string where = "[[dof]] " + dof.name;
    if (find_named(hand.dofs_, dof.name) >= 0) return fail("there are two of this name", where);
    if (auto known = only_keys(
            table,
            {"name", "joint", "lower", "upper", "max_velocity", "closing", "squeeze", "coupling"},
            where, hand_page);
        !known)
      return tl::unexpected(known.error());

    const auto leader = text_of(table, "joint", where);
    if (!leader) return tl::unexpected(leader.error());
    dof.joint = find_named(hand.joints_, *leader);
    if (dof.joint < 0) return fail("joint " + *leader + " is not in the URDF", where);
    const auto index = static_cast<std::size_t>(dof.joint);
    if (mimics_[index]) return fail("a joint that mimics cannot lead a DoF", where, *leader);
    if (leads(dof.joint) >= 0) return fail("joint " + *leader + " already leads a DoF", where);

    const HandJoint& joint = hand.joints_[index];
    dof.kind = joint.kind;
    const bool slides = joint.kind == JointKind::prismatic;
    double closing = 0;
    for (const auto& [key, value, otherwise] :
         std::initializer_list<std::tuple<const char*, double*, double>>{
             {"lower", &dof.lower, joint.lower},
             {"upper", &dof.upper, joint.upper},
             {"max_velocity", &dof.max_velocity, velocities_[index]},
             {"closing", &closing, 0.0},
             {"squeeze", &dof.squeeze, slides ? prismatic_squeeze : dof.squeeze}}) {
      const auto read = number_or(table, key, otherwise, where);
      if (!read) return tl::unexpected(read.error());
      *value = *read;
    }
    if (!(dof.lower < dof.upper) || dof.lower < joint.lower - tolerance ||
        dof.upper > joint.upper + tolerance)
      return fail("needs lower < upper, within the limits of joint " + joint.name, where);
    if (!(dof.max_velocity > 0) || !std::isfinite(dof.max_velocity))
      return fail("max_velocity must be positive", where, "here or in the URDF's <limit>");
    if (closing != -1 && closing != 0 && closing != 1)
      return fail("closing must be -1, 0 or 1", where);
    if (!(dof.squeeze > 0)) return fail("squeeze must be positive", where);
    dof.closing = static_cast<int>(closing);
    const auto coupling = named_of(table, "coupling", coupling_names, where);
    if (!coupling) return tl::unexpected(coupling.error());
    dof.coupling = coupling->value_or(Coupling::springs);
    return dof;
  }

  /// The DoF that a joint leads, or -1.
  int leads(int joint) const {
    const auto found = std::find_if(hand.dofs_.begin(), hand.dofs_.end(),
                                    [&](const HandDof& dof) { return dof.joint == joint; });
    return found == hand.dofs_.end() ? -1 : static_cast<int>(found - hand.dofs_.begin());
  }

  /// Follows <mimic> from joint to joint until one that leads a DoF.
  Expected<void> couple(const toml::table&) {
    for (std::size_t i = 0; i < hand.joints_.size(); ++i) {
      HandJoint& joint = hand.joints_[i];
      int at = static_cast<int>(i);
      joint.multiplier = 1;
      joint.offset = 0;
      for (std::size_t steps = 0; (joint.dof = leads(at)) < 0; ++steps) {
        const auto& mimic = mimics_[static_cast<std::size_t>(at)];
        if (!mimic)
          return fail("joint belongs to no DoF", joint.name, "give it a [[dof]] or <mimic>");
        if (steps > hand.joints_.size())
          return fail("joints mimic each other in a loop", joint.name);
        joint.offset += joint.multiplier * mimic->offset;
        joint.multiplier *= mimic->multiplier;
        at = find_named(hand.joints_, mimic->joint);
        if (at < 0)
          return fail("mimics " + mimic->joint + ", which moves nothing in the URDF", joint.name);
      }
      if (!(std::abs(joint.multiplier) < max_coupling) || !(std::abs(joint.offset) < max_coupling))
        return fail("coupling must be finite and of a size that a hand can have", joint.name);
      if (joint.multiplier == 0) return fail("coupling must not be zero", joint.name);
    }
    for (std::size_t i = 0; i < hand.joints_.size(); ++i)
      hand.joints_[i].geared_to = gear_of(hand, static_cast<int>(i));
    return {};
  }

  Expected<void> read_torques(const toml::table& root) {
    const auto table = table_of(root, "torque");
    if (!table) return tl::unexpected(table.error());
    for (const auto& [key, node] : *table)
      if (key.str() != "default" && find_named(hand.joints_, key.str()) < 0)
        return fail("names no joint of the URDF", "torque." + std::string(key.str()));
    for (HandJoint& joint : hand.joints_) {
      const auto common = number_or(*table, "default", joint.max_torque, "torque");
      if (!common) return tl::unexpected(common.error());
      const auto torque = number_or(*table, joint.name, *common, "torque");
      if (!torque) return tl::unexpected(torque.error());
      if (!(*torque > 0)) return fail("torque limit must be positive", joint.name);
      joint.max_torque = *torque;
    }
    return {};
  }

  Expected<void> read_breakaways(const toml::table& root) {
    const auto table = table_of(root, "breakaway");
    if (!table) return tl::unexpected(table.error());
    for (const auto& [key, node] : *table) {
      const std::string where = "breakaway." + std::string(key.str());
      const int index = find_named(hand.joints_, key.str());
      if (index < 0) return fail("names no joint of the URDF", where);
      HandJoint& joint = hand.joints_[static_cast<std::size_t>(index)];
      const auto torque = number(node, where);
      if (!torque) return tl::unexpected(torque.error());
      if (!(*torque > 0 && *torque <= joint.max_torque))
        return fail("must be positive and at most the joint's torque limit", where);
      const bool coupled =
          std::count_if(hand.joints_.begin(), hand.joints_.end(),
                        [&](const HandJoint& other) { return other.dof == joint.dof; }) > 1;
      if (leads(index) < 0 || !coupled)
        return fail("a clutch is on a joint that leads a DoF and has joints coupled to it", where);
      if (hand.dofs_[static_cast<std::size_t>(joint.dof)].coupling != Coupling::springs)
        return fail("a clutch lets go only of joints that are coupled by springs", where);
      joint.breakaway = *torque;
    }
    return {};
  }

  Expected<void> read_materials(const toml::table& root) {
    const auto table = table_of(root, "materials");
    if (!table) return tl::unexpected(table.error());
    for (const auto& [key, node] : *table)
      if (key.str() != "default" && find_named(hand.links_, key.str()) < 0)
        return fail("names no link of the URDF", "materials." + std::string(key.str()));
    for (HandLink& link : hand.links_) {
      const auto material =
          text_of(*table, table->contains(link.name) ? std::string_view(link.name) : "default",
                  "materials");
      if (!material) return tl::unexpected(material.error());
      link.material = *material;
    }
    return {};
  }

  Expected<void> read_fingertips(const toml::table& root) {
    const auto tables = entries(root, "fingertip");
    if (!tables) return tl::unexpected(tables.error());
    for (const toml::table* table : *tables) {
      HandFingertip tip;
      const auto name = text_of(*table, "name", "[[fingertip]]");
      if (!name) return tl::unexpected(name.error());
      tip.name = *name;
      const std::string where = "[[fingertip]] " + tip.name;
      if (find_named(hand.fingertips_, tip.name) >= 0)
        return fail("there are two of this name", where);
      if (auto known = only_keys(*table, {"name", "link", "position", "human"}, where, hand_page);
          !known)
        return known;
      const auto link = text_of(*table, "link", where);
      if (!link) return tl::unexpected(link.error());
      tip.link = find_named(hand.links_, *link);
      if (tip.link < 0) return fail("link " + *link + " is not in the URDF", where);
      const auto position = numbers(table->get("position"), 3, where + ".position");
      if (!position) return tl::unexpected(position.error());
      tip.p_LT = *position;
      const auto human = named_of(*table, "human", finger_names, where);
      if (!human) return tl::unexpected(human.error());
      tip.human = *human;
      hand.fingertips_.push_back(std::move(tip));
    }
    assign_fingers();
    return {};
  }

  /// Links between the palm and one fingertip, and what hangs on them, are that finger's.
  void assign_fingers() {
    const auto parent = [&](const HandLink& link) {
      return hand.joints_[static_cast<std::size_t>(link.joint)].parent;
    };
    std::vector<int> tips(hand.links_.size(), 0);  // whose chain leads through the link
    for (std::size_t finger = 0; finger < hand.fingertips_.size(); ++finger)
      for (int at = hand.fingertips_[finger].link; at > 0;
           at = parent(hand.links_[static_cast<std::size_t>(at)])) {
        const auto link = static_cast<std::size_t>(at);
        hand.links_[link].finger = ++tips[link] == 1 ? static_cast<int>(finger) : -1;
      }
    for (std::size_t i = 1; i < hand.links_.size(); ++i)  // parents come first
      if (tips[i] == 0)
        hand.links_[i].finger =
            hand.links_[static_cast<std::size_t>(parent(hand.links_[i]))].finger;
  }

  Expected<void> read_grasp_frame(const toml::table& root) {
    const auto X_BG = pose_in(root, "grasp_frame", hand_page);
    if (!X_BG) return tl::unexpected(X_BG.error());
    hand.X_BG_ = *X_BG;
    return {};
  }

  Expected<void> read_reach(const toml::table& root) {
    const auto table = table_of(root, "reach");
    if (!table) return tl::unexpected(table.error());
    if (auto known =
            only_keys(*table, {"opening", "engage", "clearance", "half_width"}, "reach", hand_page);
        !known)
      return known;
    Reach& reach = hand.reach_;
    for (const auto& [key, length] : std::initializer_list<std::pair<const char*, double*>>{
             {"opening", &reach.opening},
             {"engage", &reach.engage},
             {"clearance", &reach.clearance},
             {"half_width", &reach.half_width}}) {
      const auto read = number_or(*table, key, *length, "reach");
      if (!read) return tl::unexpected(read.error());
      if (!(*read > 0)) return fail("must be positive", std::string("reach.") + key);
      *length = *read;
    }
    return {};
  }

  Expected<void> read_gate(const toml::table& root) {
    const auto table = table_of(root, "gate");
    if (!table) return tl::unexpected(table.error());
    if (auto known = only_keys(*table, {"lower", "upper", "velocity", "acceleration", "effort"},
                               "gate", hand_page);
        !known)
      return known;
    HandGate& gate = hand.gate_;
    for (const auto& [key, values] :
         std::initializer_list<std::pair<const char*, std::optional<VectorXd>*>>{
             {"lower", &gate.lower},
             {"upper", &gate.upper},
             {"velocity", &gate.velocity},
             {"acceleration", &gate.acceleration},
             {"effort", &gate.effort}}) {
      if (!table->contains(key)) continue;
      const auto read = numbers(table->get(key), hand.dofs_.size(), std::string("gate.") + key);
      if (!read) return tl::unexpected(read.error());
      *values = *read;
    }
    return check_gate();
  }

  Expected<void> check_gate() const {
    for (const auto* values : {&hand.gate_.velocity, &hand.gate_.acceleration, &hand.gate_.effort})
      if (*values && !((*values)->array() > 0).all())
        return fail("velocity, acceleration and effort must be positive", "gate");
    for (std::size_t k = 0; k < hand.dofs_.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const HandDof& dof = hand.dofs_[k];
      const double lower = hand.gate_.lower ? (*hand.gate_.lower)[i] : dof.lower;
      const double upper = hand.gate_.upper ? (*hand.gate_.upper)[i] : dof.upper;
      if (!(lower < upper) || lower < dof.lower - tolerance || upper > dof.upper + tolerance)
        return fail("needs lower < upper, within the limits of DoF " + dof.name, "gate");
      if (hand.gate_.effort && (*hand.gate_.effort)[i] > max_effort(hand)[i] + tolerance)
        return fail("is more than the drives have of DoF " + dof.name, "gate.effort");
    }
    return {};
  }

  Expected<void> read_postures(const toml::table& root) {
    const auto table = table_of(root, "postures");
    if (!table) return tl::unexpected(table.error());
    for (const auto& [key, node] : *table) {
      const std::string where = "postures." + std::string(key.str());
      const auto dof = numbers(&node, hand.dofs_.size(), where);
      if (!dof) return tl::unexpected(dof.error());
      const VectorXd clamped = hand.clamp(*dof);
      Eigen::Index worst = 0;
      if ((*dof - clamped).cwiseAbs().maxCoeff(&worst) > tolerance)
        return fail(
            "is outside the limits of DoF " + hand.dofs_[static_cast<std::size_t>(worst)].name,
            where);
      hand.postures_[std::string(key.str())] = clamped;
    }
    if (!hand.postures_.contains("open")) return fail("needs the posture \"open\"", "postures");
    return {};
  }

  std::vector<std::optional<HandTree::Mimic>> mimics_;  // of each joint
  std::vector<double> velocities_;
};

Expected<HandModel> HandModel::parse(std::string_view urdf, std::string_view toml) {
  auto tree = read_hand_urdf(std::string(urdf));
  if (!tree) return tl::unexpected(located(tree.error(), "hand.urdf"));
  const auto root = parse_toml(toml, "hand.toml");
  if (!root) return tl::unexpected(root.error());
  HandLoader loader(std::move(*tree));
  if (auto done = loader.load(*root); !done)
    return tl::unexpected(located(done.error(), "hand.toml"));
  return std::move(loader.hand);
}

Expected<HandModel> HandModel::load(const std::filesystem::path& directory) {
  const std::filesystem::path files = hand_files(directory);
  const auto urdf = read_file(files / "hand.urdf", parts);
  if (!urdf) return tl::unexpected(urdf.error());
  const auto toml = read_file(files / "hand.toml", parts);
  if (!toml) return tl::unexpected(toml.error());
  auto hand = parse(*urdf, *toml);
  if (!hand) hand.error().where = (files / hand.error().where).string();
  if (hand && files != directory) return hand->mirrored();
  return hand;
}

}  // namespace prehend::model
