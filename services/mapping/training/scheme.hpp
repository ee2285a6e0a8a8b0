#pragma once

#include <array>
#include <filesystem>
#include <prehend/base/error.hpp>
#include <prehend/model/hand_model.hpp>
#include <prehend/model/human_hand.hpp>
#include <string>
#include <vector>

namespace prehend::mapping {

/// A human posture and the robot posture that shall answer it.
struct SchemePosture {
  std::string name;
  std::array<double, model::finger_count> human{};  // closure of each finger, 0 to 1
  Eigen::VectorXd robot;                            // rad, order of the hand's DoF
};

/// How a robot hand imitates a human one: data, so that a new hand needs only its postures.
struct Scheme {
  std::string name;
  std::vector<SchemePosture> postures;
  std::vector<Eigen::VectorXd> preshapes;  // rad, from where the hand may close on an object

  /// Reads TOML as in schemes/. Refuses another hand's file, fewer than two postures, no preshape,
  /// closures outside 0..1 and robot values outside the hand's limits.
  static Expected<Scheme> load(const std::filesystem::path& file, const model::HandModel& hand);
};

}  // namespace prehend::mapping
