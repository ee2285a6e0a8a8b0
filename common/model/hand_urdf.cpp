#include "common/model/hand_urdf.hpp"

#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <cmath>
#include <exception>

#include "common/model/xml.hpp"

namespace prehend::model {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t max_links = 256;
// Beyond these, sums and squares may overflow.
constexpr double max_metres = 100;
constexpr double max_kilograms = 1000;
constexpr double max_travel = 1000;  // rad or m

Vector3d vector_of(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

Pose pose_of(const urdf::Pose& pose) {
  double x = 0, y = 0, z = 0, w = 1;
  pose.rotation.getQuaternion(x, y, z, w);
  return make_pose(vector_of(pose.position), Eigen::Quaterniond(w, x, y, z).normalized());
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

/// Moment of a point mass at r, kg m².
Matrix3d point_inertia(double mass, const Vector3d& r) {
  return mass * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
}

/// Joins a mass with its centre and inertia about it, all in the link's frame, to the link's.
void add_mass(HandLink& link, double mass, const Vector3d& com, const Matrix3d& inertia) {
  const double total = link.mass + mass;
  const Vector3d middle = (link.mass * link.com_L + mass * com) / total;
  link.inertia_L +=
      inertia + point_inertia(link.mass, link.com_L - middle) + point_inertia(mass, com - middle);
  link.com_L = middle;
  link.mass = total;
}

/// Finite, and of a size that a hand can have.
bool is_sane(const Pose& X) {
  return is_finite(X) && X.translation().norm() < max_metres;
}

Expected<HandJoint> read_joint(const urdf::Joint& source) {
  HandJoint joint;
  joint.name = source.name;
  if (source.type == urdf::Joint::PRISMATIC)
    joint.kind = JointKind::prismatic;
  else if (source.type != urdf::Joint::REVOLUTE)
    return fail("joint is neither revolute, prismatic nor fixed", source.name,
                "a continuous joint becomes revolute by limits, others by several joints");
  joint.axis_J = vector_of(source.axis);
  if (!joint.axis_J.allFinite() || joint.axis_J.norm() < 1e-9)
    return fail("axis has no direction", source.name);
  joint.axis_J.normalize();
  if (!source.limits) return fail("joint has no limits", source.name, "give it a <limit>");
  joint.lower = source.limits->lower;
  joint.upper = source.limits->upper;
  joint.max_torque = source.limits->effort;
  if (!(joint.lower < joint.upper) || !(std::abs(joint.lower) < max_travel) ||
      !(std::abs(joint.upper) < max_travel) || !(joint.max_torque > 0) ||
      !std::isfinite(joint.max_torque))
    return fail(
        "limits need lower < upper, both of a size that a hand can have, and a positive effort",
        source.name);
  return joint;
}

/// Walks the parser's tree depth first, so that parents come before children and a finger's links
/// stand together.
class TreeReader {
 public:
  explicit TreeReader(std::size_t links) : left_(links) {}

  /// Adds a link's mass and shapes to tree.links[index], in whose frame it stands at X_LF, and then
  /// all that hangs on it.
  Expected<void> add(const urdf::Link& source, std::size_t index, const Pose& X_LF) {
    if (left_-- == 0) return fail("has two parents", source.name, "links must form a tree");
    if (auto read = add_mass_and_shapes(source, index, X_LF); !read) return read;
    for (const auto& child : source.child_links) {
      const urdf::Joint& joint = *child->parent_joint;
      const Pose X_LJ = X_LF * pose_of(joint.parent_to_joint_origin_transform);
      if (!is_sane(X_LJ)) return fail("origin is not finite or far away", joint.name);
      if (joint.type == urdf::Joint::FIXED) {
        if (auto added = add(*child, index, X_LJ); !added) return added;
        continue;
      }
      auto made = read_joint(joint);
      if (!made) return tl::unexpected(made.error());
      made->X_PJ = X_LJ;
      made->parent = static_cast<int>(index);
      made->child = static_cast<int>(tree.links.size());
      tree.links.push_back(empty_link(child->name, static_cast<int>(tree.joints.size())));
      tree.joints.push_back(std::move(*made));
      tree.velocities.push_back(joint.limits->velocity);
      tree.mimics.emplace_back();
      if (joint.mimic)
        tree.mimics.back() = {joint.mimic->joint_name, joint.mimic->multiplier,
                              joint.mimic->offset};
      if (auto added = add(*child, tree.links.size() - 1, Pose::Identity()); !added) return added;
    }
    return {};
  }

  static HandLink empty_link(const std::string& name, int joint) {
    HandLink link;
    link.name = name;
    link.joint = joint;
    link.com_L.setZero();
    link.inertia_L.setZero();
    return link;
  }

  std::size_t left() const { return left_; }  // links that hang on nothing
  HandTree tree;

 private:
  Expected<void> add_mass_and_shapes(const urdf::Link& source, std::size_t index,
                                     const Pose& X_LF) {
    HandLink& link = tree.links[index];
    if (source.inertial) {
      const urdf::Inertial& in = *source.inertial;
      const Pose X_LI = X_LF * pose_of(in.origin);
      Matrix3d inertia;
      inertia << in.ixx, in.ixy, in.ixz, in.ixy, in.iyy, in.iyz, in.ixz, in.iyz, in.izz;
      if (!(in.mass > 0) || !(in.mass < max_kilograms) || !is_sane(X_LI) ||
          !(inertia.norm() < max_kilograms * max_metres * max_metres) ||
          inertia.llt().info() != Eigen::Success)
        return fail("mass and inertia must be positive and of a size that a hand can have",
                    source.name);
      add_mass(link, in.mass, X_LI.translation(),
               X_LI.linear() * inertia * X_LI.linear().transpose());
    }
    for (const auto& collision : source.collision_array) {
      if (!collision || !collision->geometry)
        return fail("has an empty collision element", source.name);
      auto shape = shape_of(*collision->geometry);
      if (!shape) return fail(shape.error().what, source.name, shape.error().hint);
      link.collision.push_back({*shape, X_LF * pose_of(collision->origin)});
      if (!is_sane(link.collision.back().X_LS))
        return fail("origin is not finite or far away", source.name);
    }
    return {};
  }

  std::size_t left_;
};

}  // namespace

Expected<HandTree> read_hand_urdf(const std::string& text) {
  auto elements = count_xml_elements(text);  // first: the parser would overflow the stack
  if (!elements) return tl::unexpected(elements.error());
  urdf::ModelInterfaceSharedPtr source;
  try {
    source = urdf::parseURDF(text);
  } catch (const std::exception& error) {  // of numbers that it cannot read
    return fail(std::string("a number cannot be read: ") + error.what(), {},
                "look for text where a number belongs; `prehend hand check` names the place");
  }
  if (!source || !source->getRoot())
    return fail("is no robot description", {}, "`prehend hand check` says what is wrong with it");
  if (source->links_.size() > max_links)
    return fail("has more than " + std::to_string(max_links) + " links");

  TreeReader reader(source->links_.size());
  const urdf::Link& root = *source->getRoot();
  reader.tree.links.push_back(TreeReader::empty_link(root.name, -1));
  if (auto added = reader.add(root, 0, Pose::Identity()); !added)
    return tl::unexpected(added.error());
  if (reader.left() > 0) return fail("links are not connected", root.name);
  if (reader.tree.joints.empty()) return fail("has no joint that moves");

  std::size_t shapes = 0;
  for (const HandLink& link : reader.tree.links) {
    if (!(link.mass > 0)) return fail("link has no mass", link.name, "give it an <inertial>");
    shapes += link.collision.size();
  }
  // The parser drops elements that it does not understand; a hand must not lose any.
  if (shapes != static_cast<std::size_t>((*elements)["collision"]))
    return fail("a collision element was not understood", {},
                "only boxes, cylinders and spheres of positive size");
  return std::move(reader.tree);
}

}  // namespace prehend::model
