#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/demonstration/core/recognition/hand_sample.hpp"

namespace prehend::test {

/// Takes of people who do not exist: each kind of grasp has an opening, a direction and a speed,
/// people differ by their hands' sizes, and every sample is noisy.
struct MadeTakes {
  int people = 6, trials = 4, samples = 12;
  std::vector<std::string> classes{"bottle", "cup", "knife"};
  double noise = 0.004;  // m
  std::uint64_t seed = 1;
};
std::vector<demonstration::Take> made_takes(const MadeTakes& wanted);

/// The same as a file in the columns of the real ones.
std::string to_csv(const std::vector<demonstration::Take>& takes);

}  // namespace prehend::test
