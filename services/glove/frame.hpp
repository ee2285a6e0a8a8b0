#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <prehend/base/pose.hpp>
#include <prehend/base/time.hpp>
#include <prehend/model/human_hand.hpp>
#include <string_view>
#include <vector>

namespace prehend::glove {

/// Where a sensor sits on the hand. The order of the first six is that of the messages.
enum class Site { back_of_hand, thumb, index, middle, ring, little, forearm };

/// The finger that carries a sensor, if a finger does.
std::optional<model::Finger> finger_of(Site site);

/// One sensor as the device gave it: nothing has been checked yet. T: the tracker's frame.
struct Reading {
  Site site = Site::back_of_hand;
  bool valid = true;  // false: the device itself says that it saw nothing
  Eigen::Vector3d p_TS = Eigen::Vector3d::Zero();            // m
  Eigen::Quaterniond q_TS = Eigen::Quaterniond::Identity();  // need not have unit norm
};

/// All sensors at one moment.
struct Frame {
  std::uint64_t sequence = 0;  // counts from 0
  Time stamp{};                // acquisition
  std::vector<Reading> readings;
  std::vector<double> joint_angles;  // rad, order of model::HumanPosture; empty: not measured
  bool left = false;                 // a left hand that the device mirrored into a right one
};

struct Fingertip {
  bool valid = false;
  Eigen::Vector3d p_HF = Eigen::Vector3d::Zero();  // m
};

/// A hand, clean: what hand/posture says.
struct Posture {
  std::uint64_t sequence = 0;
  Time stamp{};  // of the frame that caused it
  Pose X_WH = Pose::Identity();
  std::array<Fingertip, model::finger_count> fingertips;
  double quality = 0;  // 0 to 1: share of the sensors that were good
  std::vector<double> joint_angles;
};

/// Sites of a tracker's sensors in the order of their addresses, for 1 to 6 sensors.
const std::vector<Site>& sites_by_address();

}  // namespace prehend::glove
