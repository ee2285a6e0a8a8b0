#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "common/model/hand_model.hpp"

namespace prehend::grasping {

/// Named postures from which a hand can close: «open», then all others that have half their way
/// before them.
std::vector<std::string> opened_postures(const model::HandModel& hand);

/// How a hand may be before it closes, the likeliest first: open; open with all that does not close
/// (spread, abduction) by 1/12, 1/2 and 1/3 of its range towards the farther one of its limits; its
/// other named postures that can close. Each once. DoF values, rad or m.
std::vector<Eigen::VectorXd> preshapes_of(const model::HandModel& hand);

/// A hand before it closes, and what of it stays so.
struct Preshape {
  Eigen::VectorXd dof;        // rad or m
  std::vector<bool> resting;  // of each DoF: keeps its value. Empty: all close that can
};

/// How a hand may close on what stands before it, the likeliest first: from preshapes_of(), and
/// from its postures with all fingers opened wide (the thumb stays turned against the others); by
/// all fingers, by thumb and fingers near the index finger, and by nearly straight fingers that
/// turn about their bases, since bent ones press on nothing behind what is thin.
std::vector<Preshape> ways_to_close(const model::HandModel& hand);

}  // namespace prehend::grasping
