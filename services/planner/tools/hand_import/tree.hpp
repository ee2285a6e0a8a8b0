#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "services/planner/tools/hand_import/robot.hpp"

namespace prehend::planner {

/// Which joint leads to which link. Safe for any robot, also where joints form loops.
class Tree {
 public:
  explicit Tree(const Robot& robot);

  /// Links that are no joint's child, in the order of the file.
  const std::vector<std::string>& roots() const { return roots_; }
  /// Indices of the joints below a link, each once, parents before children.
  std::vector<std::size_t> below(const std::string& link) const;
  /// X_BL of every link below a root (B: the root), at the given values of the joints (by index).
  std::map<std::string, Pose> poses(const std::string& root,
                                    const std::vector<double>& values) const;

 private:
  const Robot& robot_;
  std::vector<std::string> roots_;
  std::multimap<std::string, std::size_t> children_;  // joints by parent link
};

/// Values of all joints when the leading ones are at 0 or the limit nearest to it. Couplings that
/// cannot be followed count as 0.
std::vector<double> rest_values(const Robot& robot);

/// The index of the joint that leads this one through its <mimic>s, and how it follows. None for a
/// loop or a missing joint.
struct Leader {
  std::size_t joint = 0;
  double multiplier = 1, offset = 0;
};
std::optional<Leader> leader_of(const Robot& robot, std::size_t joint);

/// The values that a joint takes while the one that leads it goes through its range, least first.
/// None for a joint that leads, and where no range is known.
std::optional<std::pair<double, double>> followed_range(const Robot& robot, std::size_t joint);

}  // namespace prehend::planner
