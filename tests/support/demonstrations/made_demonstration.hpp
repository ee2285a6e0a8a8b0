#pragma once

#include <cstdint>
#include <vector>

#include "services/demonstration/core/segmentation/segmenter.hpp"

namespace prehend::test {

/// A person who does not exist takes objects somewhere, one after the other.
struct MadeDemonstration {
  int objects = 1;
  double rate = 30;           // Hz
  double noise = 0.001;       // m, of hand and aperture; objects twice that
  bool lost_in_hand = true;   // cameras do not see an object that is held
  bool rests_between = true;  // the hand comes to rest between two objects
  std::uint64_t seed = 1;     // of person, places and times
};

/// What is seen, and when which phase truly was.
struct Shown {
  std::vector<demonstration::SceneSample> samples;
  std::vector<demonstration::Segment> truth;
};

/// Hands move and fingers close by minimum jerk [Flash1985]; fingers close from 60 to 80 % of the
/// reach on. A phase begins with the instant at which the movement that defines it begins.
Shown made_demonstration(const MadeDemonstration& wanted);

}  // namespace prehend::test
