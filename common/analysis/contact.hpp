#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace prehend::analysis {

/// A touch between a hand and an object. O: the object's frame, whose origin is its centre of mass.
/// Its forces fill the friction cone: |tangential| <= friction * normal; without friction, a ray.
/// A soft finger (torsion > 0) also bears a moment about the normal, in the ellipsoid
/// |tangential|² / friction² + moment² / torsion² <= normal².
struct Contact {
  std::string link;          // of the hand
  Eigen::Vector3d p_OC;      // m
  Eigen::Vector3d normal_O;  // unit, into the object
  double friction = 0;       // coefficient of the two materials
  double force = 0;          // N, along the normal
  double depth = 0;          // m, penetration, 0 or more
  double torsion = 0;        // m, greatest moment about the normal per unit of normal force
  Eigen::Vector3d tangent_O =
      Eigen::Vector3d::Zero();  // towards the first friction edge; zero: any
  int hand = 0;                 // whose link, where several hands hold the object
};

/// So many contacts of a grasp count, as in GraspIt!.
inline constexpr std::size_t max_contacts = 10;

/// At most `most` of the contacts, spread as widely over the object as possible (farthest points
/// first, beginning with the strongest contact). Keeps the cost of a wrench space bounded.
std::vector<Contact> spread_contacts(const std::vector<Contact>& contacts, std::size_t most);

}  // namespace prehend::analysis
