#include "common/analysis/grasp_map.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>

#include "common/analysis/contact_wrenches.hpp"

namespace prehend::analysis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double min_singular = 1e-9;  // of the largest: below is nothing

/// All joints that move a link.
std::vector<int> joints_moving(const model::HandModel& hand, int link) {
  std::vector<int> joints;
  for (int joint = hand.links()[static_cast<std::size_t>(link)].joint; joint >= 0;) {
    joints.push_back(joint);
    const int parent = hand.joints()[static_cast<std::size_t>(joint)].parent;
    joint = hand.links()[static_cast<std::size_t>(parent)].joint;
  }
  return joints;
}

}  // namespace

MatrixXd grasp_map(const std::vector<Contact>& contacts, double torque_scale) {
  MatrixXd map(6, 4 * static_cast<Index>(contacts.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    Eigen::Matrix<double, 6, 4> part = contact_map(contacts[i], torque_scale);
    const Vector3d n = contacts[i].normal_O.normalized();
    if (contacts[i].friction == 0)
      part.leftCols<3>() = (part.leftCols<3>() * n * n.transpose()).eval();
    part.col(3) *= contacts[i].torsion > 0 ? torque_scale : 0;
    map.middleCols<4>(4 * static_cast<Index>(i)) = part;
  }
  return map;
}

int internal_force_dimension(const std::vector<Contact>& contacts, double torque_scale) {
  if (contacts.empty()) return 0;
  Index transmitted = 0;
  for (const Contact& contact : contacts)
    transmitted += (contact.friction > 0 ? 3 : 1) + (contact.torsion > 0);
  Eigen::JacobiSVD<MatrixXd> svd(grasp_map(contacts, torque_scale));
  svd.setThreshold(min_singular);
  return static_cast<int>(transmitted - svd.rank());
}

Expected<MatrixXd> contact_jacobian(const model::HandModel& hand, const VectorXd& joint_angles,
                                    const Pose& X_BO, const std::vector<Contact>& contacts) {
  const auto joints = static_cast<Index>(hand.joints().size());
  if (joint_angles.size() != joints || !joint_angles.allFinite())
    return fail(
        fmt::format("has {} angles, {} has {} joints", joint_angles.size(), hand.name(), joints),
        "joints", "give a finite angle in radians for each joint, or name the right --hand");
  const std::vector<Pose> X_BL = hand.link_poses(joint_angles);
  const Eigen::Matrix3d R_OB = X_BO.linear().transpose();
  MatrixXd jacobian = MatrixXd::Zero(4 * static_cast<Index>(contacts.size()), joints);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto row = 4 * static_cast<Index>(i);
    const auto link = std::find_if(hand.links().begin(), hand.links().end(),
                                   [&](const auto& each) { return each.name == contacts[i].link; });
    if (link == hand.links().end())
      return fail("contact is on no link of the hand", contacts[i].link, hand.name());
    const Vector3d p_BC = X_BO * contacts[i].p_OC;
    const Vector3d n_B = X_BO.linear() * contacts[i].normal_O.normalized();
    for (const int index : joints_moving(hand, static_cast<int>(link - hand.links().begin()))) {
      const model::HandJoint& joint = hand.joints()[static_cast<std::size_t>(index)];
      // A joint's axis stands still in the frame that it moves.
      const Pose& X_BJ = X_BL[static_cast<std::size_t>(joint.child)];
      const Vector3d axis_B = X_BJ.linear() * joint.axis_J;
      if (joint.kind == model::JointKind::prismatic) {
        jacobian.block<3, 1>(row, index) = R_OB * axis_B;
      } else {
        jacobian.block<3, 1>(row, index) = R_OB * axis_B.cross(p_BC - X_BJ.translation());
        jacobian(row + 3, index) = axis_B.dot(n_B);
      }
    }
  }
  return jacobian;
}

MatrixXd coupling(const model::HandModel& hand) {
  MatrixXd made = MatrixXd::Zero(static_cast<Index>(hand.joints().size()),
                                 static_cast<Index>(hand.dofs().size()));
  for (Index i = 0; i < made.rows(); ++i) {
    const model::HandJoint& joint = hand.joints()[static_cast<std::size_t>(i)];
    made(i, joint.dof) = joint.multiplier;
  }
  return made;
}

MatrixXd object_jacobian(const std::vector<Contact>& contacts, double torque_scale,
                         const MatrixXd& jacobian, const MatrixXd& coupling) {
  MatrixXd velocities = jacobian * coupling;
  for (Index row = 3; row < velocities.rows(); row += 4) velocities.row(row) *= torque_scale;
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> inverse;
  inverse.setThreshold(min_singular);
  inverse.compute(grasp_map(contacts, torque_scale).transpose());
  return inverse.solve(velocities);
}

Transmission transmission(const MatrixXd& map) {
  if (map.size() == 0) return {};
  const VectorXd s = Eigen::JacobiSVD<MatrixXd>(map).singularValues();
  Transmission made;
  if (!(s[0] > 0)) return made;
  made.smallest = s[s.size() - 1] > min_singular * s[0] ? s[s.size() - 1] : 0;
  made.isotropy = made.smallest / s[0];
  made.volume = made.smallest > 0 ? s.prod() : 0;
  return made;
}

}  // namespace prehend::analysis
