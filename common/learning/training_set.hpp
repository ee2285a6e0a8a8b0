#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/pose.hpp"

namespace prehend::learning {

/// One posture of a person's hand and the one of the robot hand that shall answer it.
struct TrainingPair {
  Eigen::VectorXd features;
  Eigen::VectorXd dof;  // rad, order of the hand's description
  std::string user;
  unsigned take = 0;                               // counts a user's recordings
  std::string posture;                             // name of the posture or of the grasp
  std::string object;                              // empty: none at hand
  std::string shape;                               // of the object; empty: none
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  // m, meaning by shape
  std::string source;                              // synthetic, teach, recording
  Pose X_OG = Pose::Identity();                    // grasp frame on the object that the hand was at
};

struct TrainingSet {
  std::string hand, scheme;
  std::vector<std::string> dof_names;
  std::vector<TrainingPair> pairs;
};

/// What training relies on: at least two different postures, the same number of features
/// everywhere, a DoF value for every name, everything finite. Errors name the pair.
Expected<void> check(const TrainingSet& set);

/// Protobuf bytes, the same for the same set, and the way back; parsing checks the set.
std::string serialise(const TrainingSet& set);
Expected<TrainingSet> parse_training_set(const std::string& bytes);

/// The same as a sealed file of kind «training-set».
Expected<void> save(const std::filesystem::path& file, const TrainingSet& set);
Expected<TrainingSet> load_training_set(const std::filesystem::path& file);

}  // namespace prehend::learning
