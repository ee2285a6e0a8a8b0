#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/model/hand_model.hpp"
#include "services/robot/core/driver.hpp"

namespace prehend::robot {

/// What a fingertip presses with. B: the hand's base.
struct TipPressure {
  bool pressing = false;
  double pressure = 0;    // N
  Eigen::Vector3d way_B;  // unit: where the tip goes as the hand closes
  Eigen::Vector3d p_BT;   // m
};

/// Of each fingertip, in order of hand.fingertips(), as the drives' efforts say; none where the
/// robot tells none. By virtual work: what a DoF spends is what the tips press, each as far as it
/// goes with that DoF; of several answers the one with the least pressures. Only what closes and
/// stands still counts, since what moves spends effort on itself, and less than a twentieth of the
/// whole effort is friction. What the palm or the middle of a finger bears is taken for its tip's.
std::vector<TipPressure> tip_pressures(const model::HandModel& hand, const Reading& reading);

}  // namespace prehend::robot
