#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/analysis/contact.hpp"
#include "common/base/error.hpp"

namespace prehend::analysis {

using Wrench = Eigen::Matrix<double, 6, 1>;

/// Contact forces within the friction pyramids of friction_edges(), with what they cost.
struct GripForces {
  Eigen::Matrix4Xd forces;  // a column a contact: force_O in N, moment about the normal in N m
  Eigen::VectorXd torques;  // that the joints give, N m or N
  double effort = 0;        // largest |torque| / limit; above 1 the hand is too weak
};

/// Force optimisation: the forces with the least effort that hold the object against a load, and of
/// these the ones with the least sum of normal forces. load_O: the wrench (N, N m about O) that
/// acts on the object. jacobian: of contact_jacobian(); limits: of each of its joints, positive.
/// All joints count as driven; the weight of the fingers and their friction are left out. Nothing
/// when the friction of the contacts cannot hold the load, whatever the torques. The linear
/// programs of Kerr & Roth (Analysis of multifingered hands, IJRR 4(4), 1986), with the torques as
/// the cost.
Expected<std::optional<GripForces>> least_torques(const std::vector<Contact>& contacts,
                                                  const Wrench& load_O,
                                                  const Eigen::MatrixXd& jacobian,
                                                  const Eigen::VectorXd& limits, int edges = 8);

/// An internal force: the contacts squeeze the object with normal forces that add up to 1 N and
/// leave it at rest. With a margin above 0 and wrenches of rank 6 there is force closure (Murray,
/// Li & Sastry, A mathematical introduction to robotic manipulation, 1994, section 5.4).
struct Squeeze {
  Eigen::Matrix4Xd forces;  // a column a contact, as in GripForces
  double margin = 0;        // the least use of any friction edge, N; 0: a contact is about to slip
};

/// The squeeze with the greatest margin; nothing when the contacts cannot squeeze at all.
Expected<std::optional<Squeeze>> best_squeeze(const std::vector<Contact>& contacts, int edges = 8);

}  // namespace prehend::analysis
