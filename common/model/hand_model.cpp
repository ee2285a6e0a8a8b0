#include "hand_model.hpp"

#include <toml++/toml.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>

namespace prehend::model {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

Vector3d vector_of(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

Pose pose_of(const urdf::Pose& pose) {
  double x = 0, y = 0, z = 0, w = 1;
  pose.rotation.getQuaternion(x, y, z, w);
  return make_pose(vector_of(pose.position), Eigen::Quaterniond(w, x, y, z).normalized());
}

Expected<std::string> read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return fail("cannot be read", file.string(), "a hand is hand.urdf and hand.toml");
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Occurrences of <element in XML text, outside comments.
std::size_t count_elements(std::string text, const std::string& element) {
  for (std::size_t begin; (begin = text.find("<!--")) != std::string::npos;) {
    const std::size_t end = text.find("-->", begin);
    text.erase(begin, end == std::string::npos ? end : end + 3 - begin);
  }
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find("<" + element, at)) != std::string::npos; ++count)
    at += element.size() + 1;
  return count;
}

Expected<Shape> shape_of(const urdf::Geometry& geometry) {
  Shape shape;
  if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry)) {
    shape = {ShapeKind::box, vector_of(box->dim)};
  } else if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry)) {
    shape = {ShapeKind::cylinder, {cylinder->radius, cylinder->radius, cylinder->length}};
  } else if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&geometry)) {
    shape = {ShapeKind::sphere, Vector3d::Constant(sphere->radius)};
  } else {
    return fail("has a collision mesh", {}, "use boxes, cylinders and spheres");
  }
  if (!is_valid(shape)) return fail("has a collision shape of no size");
  return shape;
}

Expected<HandLink> read_link(const urdf::Link& source) {
  HandLink link;
  link.name = source.name;
  if (!source.inertial || !(source.inertial->mass > 0) || !std::isfinite(source.inertial->mass))
    return fail("link has no mass", source.name, "give it an <inertial>");
  link.mass = source.inertial->mass;
  const Pose X_LI = pose_of(source.inertial->origin);
  link.com_L = X_LI.translation();
  const urdf::Inertial& in = *source.inertial;
  Eigen::Matrix3d inertia;
  inertia << in.ixx, in.ixy, in.ixz, in.ixy, in.iyy, in.iyz, in.ixz, in.iyz, in.izz;
  link.inertia_L = X_LI.linear() * inertia * X_LI.linear().transpose();
  if (!link.com_L.allFinite() || !link.inertia_L.allFinite() ||
      !(link.inertia_L.diagonal().minCoeff() > 0))
    return fail("inertia must be finite and positive", source.name);
  for (const auto& collision : source.collision_array) {
    if (!collision || !collision->geometry) return fail("empty collision element", source.name);
    auto shape = shape_of(*collision->geometry);
    if (!shape) return fail(shape.error().what, source.name, shape.error().mend);
    link.collision.push_back({*shape, pose_of(collision->origin)});
    if (!is_finite(link.collision.back().X_LS)) return fail("origin is not finite", source.name);
  }
  return link;
}

Expected<HandJoint> read_joint(const urdf::Joint& source) {
  if (source.type != urdf::Joint::REVOLUTE)
    return fail("joint is not revolute", source.name, "merge links joined by other joints");
  HandJoint joint;
  joint.name = source.name;
  joint.X_PJ = pose_of(source.parent_to_joint_origin_transform);
  joint.axis_J = vector_of(source.axis);
  if (!is_finite(joint.X_PJ) || !joint.axis_J.allFinite() || joint.axis_J.norm() < 1e-9)
    return fail("origin or axis is not finite", source.name);
  joint.axis_J.normalize();
  if (!source.limits) return fail("joint has no limits", source.name, "give it a <limit>");
  joint.lower = source.limits->lower;
  joint.upper = source.limits->upper;
  joint.max_torque = source.limits->effort;
  if (!(joint.lower < joint.upper) || !std::isfinite(joint.lower) || !std::isfinite(joint.upper) ||
      !(joint.max_torque > 0))
    return fail("limits need lower < upper and a positive effort", source.name);
  return joint;
}

/// Numbers of a TOML array, exactly `count` of them and finite.
Expected<VectorXd> numbers(const toml::node_view<const toml::node>& node, std::size_t count,
                           const std::string& where) {
  const toml::array* array = node.as_array();
  if (!array || array->size() != count)
    return fail("needs " + std::to_string(count) + " numbers", where);
  VectorXd values(static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = array->at(i).value<double>();
    if (!number || !std::isfinite(*number)) return fail("needs finite numbers", where);
    values[static_cast<Eigen::Index>(i)] = *number;
  }
  return values;
}

template <class Items>
int find_named(const Items& items, const std::string& name) {
  const auto found =
      std::find_if(items.begin(), items.end(), [&](const auto& item) { return item.name == name; });
  return found == items.end() ? -1 : static_cast<int>(found - items.begin());
}

}  // namespace

/// Fills a HandModel; the only one who changes it.
class HandLoader {
 public:
  Expected<void> load_urdf(const std::string& text) {
    const auto source = urdf::parseURDF(text);
    if (!source || !source->getRoot()) return fail("is no robot description");
    std::size_t shapes = 0;
    // The parser drops elements that it does not understand; a hand must not lose any.
    if (auto added = add_link(*source->getRoot(), -1); !added) return added;
    for (const HandLink& link : hand.links_) shapes += link.collision.size();
    if (shapes != count_elements(text, "collision"))
      return fail("a collision element was not understood", {},
                  "only boxes, cylinders and spheres of positive size");
    if (hand.links_.size() != source->links_.size()) return fail("links are not connected");
    for (const HandJoint& joint : hand.joints_) sources_.push_back(source->getJoint(joint.name));
    return {};
  }

  Expected<void> load_toml(const toml::table& root) {
    hand.name_ = root["name"].value_or(std::string());
    if (hand.name_.empty()) return fail("needs a name");
    for (const auto& step : {&HandLoader::read_dofs, &HandLoader::couple, &HandLoader::read_surface,
                             &HandLoader::read_frames, &HandLoader::read_postures})
      if (auto done = (this->*step)(root); !done) return done;
    return {};
  }

  HandModel hand;

 private:
  /// Depth first, so that parents come before children and a finger's links stand together.
  Expected<void> add_link(const urdf::Link& source, int joint) {
    auto link = read_link(source);
    if (!link) return tl::unexpected(link.error());
    link->joint = joint;
    const int index = static_cast<int>(hand.links_.size());
    hand.links_.push_back(std::move(*link));
    if (joint >= 0) hand.joints_[static_cast<std::size_t>(joint)].child = index;
    for (const auto& child : source.child_links) {
      auto made = read_joint(*child->parent_joint);
      if (!made) return tl::unexpected(made.error());
      made->parent = index;
      hand.joints_.push_back(std::move(*made));
      if (auto added = add_link(*child, static_cast<int>(hand.joints_.size()) - 1); !added)
        return added;
    }
    return {};
  }

  Expected<void> read_dofs(const toml::table& root) {
    const toml::array* entries = root["dof"].as_array();
    if (!entries || entries->empty() || entries->size() > 32)
      return fail("needs 1 to 32 [[dof]] entries");
    for (const toml::node& node : *entries) {
      const toml::node_view<const toml::node> entry(node);
      HandDof dof;
      dof.name = entry["name"].value_or(std::string());
      const std::string leader = entry["joint"].value_or(std::string());
      const int joint = find_named(hand.joints_, leader);
      if (dof.name.empty() || joint < 0)
        return fail("[[dof]] needs a name and a joint of the URDF", leader);
      const auto& source = *sources_[static_cast<std::size_t>(joint)];
      if (source.mimic) return fail("a joint that mimics cannot lead a DoF", leader);
      dof.lower = entry["lower"].value_or(hand.joints_[static_cast<std::size_t>(joint)].lower);
      dof.upper = entry["upper"].value_or(hand.joints_[static_cast<std::size_t>(joint)].upper);
      dof.max_velocity = entry["max_velocity"].value_or(source.limits->velocity);
      dof.closing = entry["closing"].value_or(0);
      if (!(dof.lower < dof.upper) || !std::isfinite(dof.lower) || !std::isfinite(dof.upper) ||
          !(dof.max_velocity > 0) || std::abs(dof.closing) > 1)
        return fail("limits, velocity or closing are wrong", dof.name,
                    "lower < upper, max_velocity > 0, closing -1, 0 or 1");
      leaders_.push_back(joint);
      hand.dofs_.push_back(std::move(dof));
    }
    return {};
  }

  /// Follows <mimic> from joint to joint until one that leads a DoF.
  Expected<void> couple(const toml::table&) {
    for (std::size_t i = 0; i < hand.joints_.size(); ++i) {
      HandJoint& joint = hand.joints_[i];
      int at = static_cast<int>(i);
      joint.multiplier = 1;
      joint.offset = 0;
      for (std::size_t steps = 0;; ++steps) {
        const auto leads = std::find(leaders_.begin(), leaders_.end(), at);
        if (leads != leaders_.end()) {
          joint.dof = static_cast<int>(leads - leaders_.begin());
          break;
        }
        const auto& mimic = sources_[static_cast<std::size_t>(at)]->mimic;
        if (!mimic)
          return fail("joint belongs to no DoF", joint.name, "give it a [[dof]] or <mimic>");
        if (steps > hand.joints_.size())
          return fail("joints mimic each other in a loop", joint.name);
        joint.offset += joint.multiplier * mimic->offset;
        joint.multiplier *= mimic->multiplier;
        at = find_named(hand.joints_, mimic->joint_name);
        if (at < 0) return fail("mimics a joint that is not there", joint.name);
      }
      if (!std::isfinite(joint.multiplier) || !std::isfinite(joint.offset) || joint.multiplier == 0)
        return fail("coupling must be finite and not zero", joint.name);
    }
    return {};
  }

  Expected<void> read_surface(const toml::table& root) {
    for (HandJoint& joint : hand.joints_) {
      joint.max_torque =
          root["torque"][joint.name].value_or(root["torque"]["default"].value_or(joint.max_torque));
      if (!(joint.max_torque > 0) || !std::isfinite(joint.max_torque))
        return fail("torque limit must be positive", joint.name);
    }
    for (HandLink& link : hand.links_) {
      link.material = root["materials"][link.name].value_or(
          root["materials"]["default"].value_or(std::string()));
      if (link.material.empty()) return fail("has no material", link.name, "see [materials]");
    }
    const toml::array* tips = root["fingertip"].as_array();
    if (!tips || tips->empty()) return fail("needs [[fingertip]] entries");
    for (const toml::node& node : *tips) {
      const toml::node_view<const toml::node> entry(node);
      HandFingertip tip;
      tip.name = entry["name"].value_or(std::string());
      const std::string link = entry["link"].value_or(std::string());
      tip.link = find_named(hand.links_, link);
      if (tip.link < 0) return fail("fingertip is on no link of the URDF", link);
      const auto position = numbers(entry["position"], 3, "fingertip " + tip.name);
      if (!position) return tl::unexpected(position.error());
      tip.p_LT = *position;
      hand.fingertips_.push_back(std::move(tip));
    }
    return {};
  }

  Expected<void> read_frames(const toml::table& root) {
    const auto p = numbers(root["grasp_frame"]["position"], 3, "grasp_frame.position");
    if (!p) return tl::unexpected(p.error());
    const auto q = numbers(root["grasp_frame"]["orientation"], 4, "grasp_frame.orientation");
    if (!q) return tl::unexpected(q.error());
    const auto X_BG =
        checked_pose(Vector3d(*p), Eigen::Quaterniond((*q)[0], (*q)[1], (*q)[2], (*q)[3]));
    if (!X_BG) return tl::unexpected(X_BG.error());
    hand.X_BG_ = *X_BG;
    const auto reach = root["reach"];
    hand.reach_.opening = reach["opening"].value_or(hand.reach_.opening);
    hand.reach_.engage = reach["engage"].value_or(hand.reach_.engage);
    hand.reach_.clearance = reach["clearance"].value_or(hand.reach_.clearance);
    hand.reach_.half_width = reach["half_width"].value_or(hand.reach_.half_width);
    for (const double length :
         {hand.reach_.opening, hand.reach_.engage, hand.reach_.clearance, hand.reach_.half_width})
      if (!(length > 0) || !std::isfinite(length)) return fail("must be positive", "reach");
    return {};
  }

  Expected<void> read_postures(const toml::table& root) {
    if (const toml::table* postures = root["postures"].as_table())
      for (const auto& [name, node] : *postures) {
        const auto dof = numbers(toml::node_view<const toml::node>(node), hand.dofs_.size(),
                                 "posture " + std::string(name.str()));
        if (!dof) return tl::unexpected(dof.error());
        hand.postures_[std::string(name.str())] = hand.clamp(*dof);
      }
    if (!hand.postures_.contains("open")) return fail("needs the posture \"open\"", "postures");
    return {};
  }

  std::vector<int> leaders_;                        // joint of each DoF
  std::vector<urdf::JointConstSharedPtr> sources_;  // of each joint
};

Expected<HandModel> HandModel::load(const std::filesystem::path& directory) {
  const auto urdf_file = directory / "hand.urdf", toml_file = directory / "hand.toml";
  const auto text = read_text(urdf_file);
  if (!text) return tl::unexpected(text.error());
  const auto located = [](Error error, const std::filesystem::path& file) {
    error.where = file.string() + (error.where.empty() ? "" : ": " + error.where);
    return tl::unexpected(std::move(error));
  };
  HandLoader loader;
  if (auto done = loader.load_urdf(*text); !done) return located(done.error(), urdf_file);
  toml::table root;
  try {
    root = toml::parse_file(toml_file.string());
  } catch (const toml::parse_error& error) {
    return fail(std::string(error.description()), toml_file.string(), "hand.toml is TOML");
  }
  if (auto done = loader.load_toml(root); !done) return located(done.error(), toml_file);
  return std::move(loader.hand);
}

Eigen::VectorXd HandModel::joint_angles(const Eigen::VectorXd& dof) const {
  VectorXd q(static_cast<Eigen::Index>(joints_.size()));
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const HandJoint& joint = joints_[static_cast<std::size_t>(i)];
    q[i] = joint.multiplier * dof[joint.dof] + joint.offset;
  }
  return q;
}

Eigen::VectorXd HandModel::clamp(const Eigen::VectorXd& dof) const {
  VectorXd clamped = dof;
  for (Eigen::Index i = 0; i < clamped.size(); ++i) {
    const HandDof& limits = dofs_[static_cast<std::size_t>(i)];
    clamped[i] = std::clamp(clamped[i], limits.lower, limits.upper);
  }
  return clamped;
}

std::vector<Pose> HandModel::link_poses(const Eigen::VectorXd& joint_angles) const {
  std::vector<Pose> X_BL(links_.size(), Pose::Identity());
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const HandJoint& joint = joints_[i];
    X_BL[static_cast<std::size_t>(joint.child)] =
        X_BL[static_cast<std::size_t>(joint.parent)] * joint.X_PJ *
        Eigen::AngleAxisd(joint_angles[static_cast<Eigen::Index>(i)], joint.axis_J);
  }
  return X_BL;
}

std::vector<Eigen::Vector3d> HandModel::fingertip_positions(const Eigen::VectorXd& dof) const {
  const std::vector<Pose> X_BL = link_poses(joint_angles(dof));
  std::vector<Vector3d> tips;
  for (const HandFingertip& tip : fingertips_)
    tips.push_back(X_BL[static_cast<std::size_t>(tip.link)] * tip.p_LT);
  return tips;
}

}  // namespace prehend::model
