#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/analysis/contact.hpp"
#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::analysis {

/// G, 6 x 4n: object wrench (f, τ/ρ) of all contacts' (force_O, moment about the normal / ρ),
/// stacked. What a contact does not transmit (tangential force without friction, moment without
/// torsion) gives zero columns. Gᵀ takes an object's twist (v, ρω) in O to the velocities of its
/// contacts and ρ times their turning about the normal.
Eigen::MatrixXd grasp_map(const std::vector<Contact>& contacts, double torque_scale);

/// Contact forces that leave the object at rest: dimension of what G takes to zero, among the
/// components that the contacts transmit.
int internal_force_dimension(const std::vector<Contact>& contacts, double torque_scale);

/// J, 4n x joints: velocity of the contacts (in O, m/s; turning about the normal, rad/s) when the
/// joints move and the object stays. Jᵀ gives the joint torques of stacked contact forces. Fails
/// when a contact names no link of the hand, or the number of joint angles is wrong.
Expected<Eigen::MatrixXd> contact_jacobian(const model::HandModel& hand,
                                           const Eigen::VectorXd& joint_angles, const Pose& X_BO,
                                           const std::vector<Contact>& contacts);

/// C, joints x DoFs: q = C · dof + offset, by the couplings of the model.
Eigen::MatrixXd coupling(const model::HandModel& hand);

/// H = (Gᵀ)⁺ J C, 6 x DoFs: twist (v, ρω) of the object when the DoFs move and the contacts stick
/// (Prattichizzo & Trinkle, Grasping, Springer Handbook of Robotics; least squares where they
/// cannot all stick). jacobian: of contact_jacobian(); coupling: C, or the identity for H of
/// joints.
Eigen::MatrixXd object_jacobian(const std::vector<Contact>& contacts, double torque_scale,
                                const Eigen::MatrixXd& jacobian, const Eigen::MatrixXd& coupling);

/// How evenly a linear map transmits, from its singular values σ, as many as the smaller of its
/// dimensions. Of G: how well the contacts bear wrenches (Li & Sastry, Task-oriented optimal
/// grasping, 1988; Kim, Oh, Yi & Suh, Optimal grasping based on non-dimensionalized performance
/// indices, IROS 2001). Of H: manipulability (Yoshikawa, Manipulability of robotic mechanisms,
/// 1985).
struct Transmission {
  double smallest = 0;  // σ: 0 in a direction that is not transmitted at all
  double isotropy = 0;  // smallest / largest σ: 1 when all directions are alike
  double volume = 0;    // product of all σ: sqrt(det(M Mᵀ)), of the ellipsoid of unit inputs
};
Transmission transmission(const Eigen::MatrixXd& map);

}  // namespace prehend::analysis
