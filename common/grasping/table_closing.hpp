#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"
#include "common/grasping/table_test.hpp"
#include "common/model/placement.hpp"

namespace prehend::grasping {

/// How a hand is put to an object that stands on a table, before its fingers close.
struct TableApproach {
  Pose X_OG = Pose::Identity();  // where its grasp frame stands
  Eigen::VectorXd preshape;      // DoF values, rad or m
  std::vector<bool> resting;     // of each DoF: keeps its preshape. Empty: all close that can
};

/// Grasp frames from everywhere where an object can be grasped in another way: from above and from
/// the side, across each pair of faces.
std::vector<Pose> approaches(const model::Shape& shape, const model::Reach& reach);

/// From above, rather than from the side.
bool is_from_above(const Pose& X_OG);

/// No part of the open hand would be in the table; the palm is where the reach of the hand allows
/// it to be.
bool clears_table(const model::HandModel& hand, const Body& object, const TableApproach& approach);

/// Closes the hand on the object where it stands, as if it could not move, unless the fingers move
/// as one: those push it between them. The grasp opens to the preshape. Fails when the hand is
/// inside the object, when the fingers find no two contacts, and when any part of the hand would
/// reach into the table.
Expected<TableGrasp> close_on_table(const model::HandModel& hand, const Body& object,
                                    const TableApproach& approach);

}  // namespace prehend::grasping
