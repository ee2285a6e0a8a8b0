#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "services/planner/tools/hand_import/mjcf_body.hpp"

namespace prehend::planner {

/// Two links that a constraint holds together: points of the first and those of the second, each in
/// its link's frame, that are at one place.
struct MjcfLoop {
  std::string first, second;
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> points;
};

/// A constraint of <equality> that holds two links of the hand; none for others, as one that holds
/// the hand in the world.
std::optional<MjcfLoop> read_loop(MjcfSource& source, const tinyxml2::XMLElement& at,
                                  const MjcfTree& tree);

/// Lets the joints of closed linkages follow the driven ones, along the straight line nearest to
/// what springs, stops and the loops make of them; those that a motor does not move become fixed.
/// False, and nothing is changed, where they do not follow one driven joint each, within 2 mm.
bool close_linkages(const std::vector<MjcfLoop>& loops, const std::set<std::string>& driven,
                    MjcfTree& tree);

}  // namespace prehend::planner
