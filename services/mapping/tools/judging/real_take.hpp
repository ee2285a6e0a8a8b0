#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "services/mapping/core/features.hpp"

namespace prehend::mapping {

/// Fingers of a real hand as a camera saw them, 30 times a second at most, with what its own
/// software says that the hand does.
struct RealTake {
  struct Frame {
    double time = 0;             // s, from the first
    Fingertips fingertips;       // in H
    double grab = 0, pinch = 0;  // 0: open, 1: a fist; 0: apart, 1: thumb and a fingertip meet
  };
  std::string name;       // of the file
  double hand_scale = 1;  // by which its fingers are longer than an average hand's
  std::vector<Frame> frames;
};

/// Reads a recording of a Leap (CSV, its columns by name; mm and µs) and keeps the right hand, or
/// one of 21 landmarks (l0_x to l20_z, m), of a right hand at 30 Hz, which says no strengths. In H
/// the middle knuckle lies where that of a hand of this size does; the size is where index and
/// little finger reach furthest. Fails on a file that is none or has fewer than ten good rows of a
/// right hand.
Expected<RealTake> load_real_take(const std::filesystem::path& csv);

}  // namespace prehend::mapping
