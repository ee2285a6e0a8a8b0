#pragma once

#include <map>
#include <string>
#include <vector>

#include "services/planner/tools/hand_import/mjcf_body.hpp"

namespace prehend::planner {

/// What actuators do to joints.
struct MjcfActuation {
  std::map<std::string, double> effort;       // by joint, N m or N; 0: not said
  std::map<std::string, std::string> pulled;  // by joint: the fixed tendon that moves it
  std::vector<std::vector<std::pair<std::string, double>>> tendons;  // driven: joints, coefficients
  bool any = false, unread = false;  // unread: some that move who knows what
};

MjcfActuation read_actuators(MjcfSource& source, const MjcfTree& tree);

/// Couples joints as equalities and driven tendons do: in each group of joints that move as one,
/// the one with a motor leads, else the first. Gives efforts, names joints that nothing drives, and
/// constraints that are left open.
void couple(MjcfSource& source, const MjcfActuation& actuation, MjcfTree& tree);

}  // namespace prehend::planner
