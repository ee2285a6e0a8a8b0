#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/model/human_hand.hpp"

namespace prehend::glove {

/// What is known of a user's hand.
struct UserCalibration {
  std::string user;
  double scale = 1, scale_sd = 0;  // length of the hand, 1 = average adult
  /// Of each finger, in the order of model::Finger: its three bones, from the palm to the tip, and
  /// how near and how far its tip came to the back of the hand. m.
  std::array<std::array<double, 3>, model::finger_count> bones{};
  std::array<std::array<double, 2>, model::finger_count> range{};  // 0, 0: no sensor there
  double residual = 0;  // m, that the poses shown were unlike this hand
  /// Of the sensors of a joint-angle glove: angle = gain * raw + offset. Empty: another glove.
  std::vector<double> gain, offset;

  model::HumanHand hand() const;
};

}  // namespace prehend::glove
