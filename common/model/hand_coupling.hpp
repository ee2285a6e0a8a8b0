#pragma once

#include "common/base/named_values.hpp"
#include "common/model/hand_model.hpp"

namespace prehend::model {

inline constexpr auto coupling_names = named_values<Coupling>(
    {{Coupling::springs, "springs"}, {Coupling::fingers, "fingers"}, {Coupling::rigid, "rigid"}});

/// The joint of the same DoF that moves joint i by gears or bars: the first of its finger, or the
/// one that leads the DoF. -1: it has a drive of its own.
inline int gear_of(const HandModel& hand, int i) {
  const auto joint_of = [&](int at) -> const HandJoint& {
    return hand.joints()[static_cast<std::size_t>(at)];
  };
  const int dof = joint_of(i).dof;
  const HandDof& driven = hand.dofs()[static_cast<std::size_t>(dof)];
  if (driven.coupling == Coupling::springs || i == driven.joint) return -1;
  if (driven.coupling == Coupling::rigid) return driven.joint;
  int first = -1;
  for (int link = joint_of(i).parent; link > 0;) {
    const int above = hand.links()[static_cast<std::size_t>(link)].joint;
    if (joint_of(above).dof == dof) first = above;
    link = joint_of(above).parent;
  }
  return first;
}

}  // namespace prehend::model
