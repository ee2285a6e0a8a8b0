// Reads arm.toml and joins it with what arm.urdf said to an ArmModel.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/file_text.hpp"
#include "common/base/toml_document.hpp"
#include "common/model/arm_model.hpp"
#include "common/model/hand_urdf.hpp"
#include "common/model/toml_values.hpp"

namespace prehend::model {
namespace {

constexpr const char* arm_page = "see models/arms/README.md";
constexpr const char* arm_parts = "an arm is arm.urdf and arm.toml";
constexpr double default_ramp = 0.25;  // s, from rest to full velocity
constexpr double max_speed = 100;      // rad/s
constexpr double max_range = 26;       // rad: four turns in all

/// A chain of links as the arm's, or why it is none.
Expected<ArmModel> arm_of(const HandTree& tree) {
  ArmModel arm;
  const auto add_link = [&](const HandLink& link) {
    ArmLink made{link.name, link.mass, link.com_L, link.inertia_L, link.collision, {}};
    for (const CollisionShape& shape : link.collision)
      made.capsules.push_back(capsule_around(shape));
    arm.links.push_back(std::move(made));
  };
  add_link(tree.links[0]);
  const std::size_t count = tree.joints.size();
  if (count < min_arm_joints || count > max_arm_joints)
    return fail("has " + std::to_string(count) + " joints that move; an arm has 6 or 7", {},
                count < min_arm_joints
                    ? "is a joint «fixed» that should move, or the file a part of the arm?"
                    : "make the others «fixed», or leave them out: a hand is a model of its own");
  for (std::size_t i = 0; i < count; ++i) {
    const HandJoint& joint = tree.joints[i];
    if (joint.kind != JointKind::revolute)
      return fail("slides; the joints of an arm turn", "joint " + joint.name,
                  "use a robot with revolute joints");
    if (joint.parent != static_cast<int>(i) || joint.child != static_cast<int>(i) + 1)
      return fail("branches off; an arm is one chain", "joint " + joint.name,
                  "leave out what hangs beside the chain");
    if (tree.mimics[i])
      return fail("follows another joint", "joint " + joint.name, "joints of an arm move alone");
    const double velocity = tree.velocities[i];
    if (!(velocity > 0 && velocity < max_speed))
      return fail("velocity limit must be positive, in rad/s", "joint " + joint.name,
                  "give its <limit> a velocity");
    if (joint.upper - joint.lower > max_range)
      return fail(fmt::format("may turn by {:.1f} rad; {:.0f} are allowed, four turns",
                              joint.upper - joint.lower, max_range),
                  "joint " + joint.name, "write its <limit> in radians, or make the range smaller");
    arm.joints.push_back({joint.name, joint.X_PJ, joint.axis_J, joint.lower, joint.upper, velocity,
                          velocity / default_ramp, joint.max_torque});
    add_link(tree.links[i + 1]);
  }
  arm.X_AS = arm.joints[0].X_PJ;
  return arm;
}

/// Fills an ArmModel from arm.toml.
class ArmLoader {
 public:
  explicit ArmLoader(ArmModel made) : arm(std::move(made)) {}

  Expected<void> load(const toml::table& root) {
    if (auto known = only_keys(root,
                               {"name", "payload", "redundant", "home", "shoulder", "end", "flange",
                                "limits", "collision"},
                               {}, arm_page);
        !known)
      return known;
    const auto name = text_of(root, "name", {});
    if (!name) return tl::unexpected(name.error());
    arm.name = *name;
    const auto payload = number_or(root, "payload", 0, "");
    if (!payload) return tl::unexpected(payload.error());
    if (*payload < 0) return fail("must not be negative", "payload", "kg, or leave it out");
    arm.payload = *payload;
    for (const auto& step :
         {&ArmLoader::read_frames, &ArmLoader::read_limits, &ArmLoader::read_home,
          &ArmLoader::read_redundant, &ArmLoader::read_collision})
      if (auto done = (this->*step)(root); !done) return done;
    return {};
  }

  ArmModel arm;

 private:
  Expected<void> read_frames(const toml::table& root) {
    for (const auto& [key, frame] : {std::pair<const char*, Pose*>{"shoulder", &arm.X_AS},
                                     {"end", &arm.X_LE},
                                     {"flange", &arm.X_EF}}) {
      if (!root.contains(key)) continue;
      const auto X = pose_in(root, key, arm_page);
      if (!X) return tl::unexpected(X.error());
      if (!(X->translation().norm() < 10)) return fail("is far away", key, "positions are in m");
      *frame = *X;
    }
    return {};
  }

  Expected<void> read_limits(const toml::table& root) {
    const auto table = table_of(root, "limits");
    if (!table) return tl::unexpected(table.error());
    if (auto known =
            only_keys(*table, {"lower", "upper", "velocity", "acceleration"}, "limits", arm_page);
        !known)
      return known;
    for (const auto& [key, member] :
         {std::pair<const char*, double ArmJoint::*>{"lower", &ArmJoint::lower},
          {"upper", &ArmJoint::upper},
          {"velocity", &ArmJoint::velocity},
          {"acceleration", &ArmJoint::acceleration}}) {
      if (!table->contains(key)) continue;
      const auto values = numbers(table->get(key), arm.joints.size(), std::string("limits.") + key);
      if (!values) return tl::unexpected(values.error());
      for (std::size_t i = 0; i < arm.joints.size(); ++i)
        arm.joints[i].*member = (*values)[static_cast<Eigen::Index>(i)];
    }
    for (const ArmJoint& joint : arm.joints) {
      if (!(joint.lower < joint.upper) || !(joint.upper - joint.lower <= max_range))
        return fail("lower must be less than upper, by at most four turns",
                    "limits of joint " + joint.name, "write them in radians");
      if (!(joint.velocity > 0 && joint.velocity < max_speed && joint.acceleration > 0 &&
            joint.acceleration < 1e4))
        return fail("velocity and acceleration must be positive", "limits of joint " + joint.name,
                    "rad/s and rad/s²");
    }
    return {};
  }

  Expected<void> read_home(const toml::table& root) {
    arm.home.resize(static_cast<Eigen::Index>(arm.joints.size()));
    for (std::size_t i = 0; i < arm.joints.size(); ++i)
      arm.home[static_cast<Eigen::Index>(i)] =
          std::clamp(0.0, arm.joints[i].lower, arm.joints[i].upper);
    if (!root.contains("home")) return {};
    const auto home = numbers(root.get("home"), arm.joints.size(), "home");
    if (!home) return tl::unexpected(home.error());
    for (std::size_t i = 0; i < arm.joints.size(); ++i) {
      const double q = (*home)[static_cast<Eigen::Index>(i)];
      if (q < arm.joints[i].lower || q > arm.joints[i].upper)
        return fail("is outside the limits of joint " + arm.joints[i].name, "home", "radians");
    }
    arm.home = *home;
    return {};
  }

  Expected<void> read_redundant(const toml::table& root) {
    const bool seven = arm.joints.size() == max_arm_joints;
    arm.redundant = seven ? 2 : -1;  // the turn of the upper arm, in the arms that are built
    if (!root.contains("redundant")) return {};
    const auto name = text_of(root, "redundant", {});
    if (!name) return tl::unexpected(name.error());
    arm.redundant = find_named(arm.joints, *name);
    if (!seven || arm.redundant < 0)
      return fail("«redundant» names one joint of an arm with seven", *name, arm_page);
    return {};
  }

  Expected<void> read_collision(const toml::table& root) {
    const auto table = table_of(root, "collision");
    if (!table) return tl::unexpected(table.error());
    if (auto known = only_keys(*table, {"not_checked"}, "collision", arm_page); !known)
      return known;
    if (!table->contains("not_checked")) return {};
    const toml::array* pairs = table->get("not_checked")->as_array();
    constexpr const char* form = "pairs of links, as [[\"a\", \"b\"]]";
    if (!pairs || pairs->size() > 64) return fail("needs " + std::string(form), "not_checked");
    for (const toml::node& node : *pairs) {
      const toml::array* names = node.as_array();
      if (!names || names->size() != 2) return fail("needs " + std::string(form), "not_checked");
      std::pair<int, int> found;
      for (const auto& [index, to] :
           {std::pair<std::size_t, int*>{0, &found.first}, {1, &found.second}}) {
        const auto name = names->get(index)->value<std::string>();
        *to = name ? find_named(arm.links, *name) : -1;
        if (*to < 0)
          return fail("names no link of the URDF", "not_checked: " + name.value_or("?"), form);
      }
      if (found.first > found.second) std::swap(found.first, found.second);
      arm.not_checked.push_back(found);
    }
    return {};
  }
};

}  // namespace

Expected<ArmModel> ArmModel::parse(std::string_view urdf, std::string_view toml) {
  const auto tree = read_hand_urdf(std::string(urdf));
  if (!tree) return tl::unexpected(located(tree.error(), "arm.urdf"));
  auto chain = arm_of(*tree);
  if (!chain) return tl::unexpected(located(chain.error(), "arm.urdf"));
  const auto root = parse_toml(toml, "arm.toml");
  if (!root) return tl::unexpected(root.error());
  ArmLoader loader(std::move(*chain));
  if (auto done = loader.load(*root); !done)
    return tl::unexpected(located(done.error(), "arm.toml"));
  return std::move(loader.arm);
}

Expected<ArmModel> ArmModel::load(const std::filesystem::path& directory) {
  const auto urdf = read_file(directory / "arm.urdf", arm_parts);
  if (!urdf) return tl::unexpected(urdf.error());
  const auto toml = read_file(directory / "arm.toml", arm_parts);
  if (!toml) return tl::unexpected(toml.error());
  auto arm = parse(*urdf, *toml);
  if (!arm) arm.error().where = (directory / arm.error().where).string();
  return arm;
}

}  // namespace prehend::model
