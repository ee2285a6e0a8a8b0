#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/model/hand_model.hpp"
#include "common/model/human_hand.hpp"
#include "services/mapping/core/grasp_type.hpp"

namespace prehend::mapping {

/// A human posture and the robot posture that shall answer it. Robot values are rad, or m of what
/// slides, in the order of the hand's DoF.
struct SchemePosture {
  std::string name;
  std::array<double, model::finger_count> human{};  // closure of each finger, 0 to 1
  double splay = 0;  // of index and little finger: 0 as in the open hand, 1 as far as they go
  Eigen::VectorXd robot;
};

/// From where the robot hand may close on an object.
struct Preshape {
  Eigen::VectorXd robot;
  std::vector<GraspType> types;  // of grasp that it is for
  std::vector<bool> resting;     // of each DoF: does not close
};

/// How a robot hand imitates a human one: data, so that a new hand needs only its postures.
struct Scheme {
  std::string name;
  SchemePosture open;
  std::vector<SchemePosture> closed;  // thumb, index, little; perhaps spread
  std::vector<Preshape> preshapes;
  /// What the mapping keeps to, within the hand's own limits: so that closing fingers do not come
  /// to lie on each other [Thesis, 5.1.2].
  Eigen::VectorXd lower, upper;

  /// Open and k levels of each closed posture in equal steps, k = (count - 1) / 3: with the three
  /// fingers 4, 7, 10 or 13 postures. Other counts are taken as the next smaller of these.
  std::vector<SchemePosture> posture_set(int count = 7) const;
  /// The four postures of [Thesis, figure 5.17], in none of these sets: index and little finger
  /// half and fully closed, thumb and little finger likewise.
  std::vector<SchemePosture> combinations() const;

  /// Reads TOML as in schemes/. Refuses another hand's file, postures that are missing or doubled,
  /// no preshape for any grasp type, closures outside 0..1 and robot values outside the limits.
  static Expected<Scheme> load(const std::filesystem::path& file, const model::HandModel& hand);
};

/// A name is a file of that name in the folder of schemes, what has a slash or ends in .toml a
/// path.
std::filesystem::path scheme_path(const std::string& scheme);

}  // namespace prehend::mapping
