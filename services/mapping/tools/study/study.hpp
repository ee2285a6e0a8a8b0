#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/grasping/planner.hpp"
#include "services/mapping/tools/judging/sharded_benchmark.hpp"
#include "services/mapping/tools/study/experiment.hpp"

namespace prehend::mapping {

struct StudyOptions {
  bool quick = false;      // few repetitions
  std::uint64_t seed = 1;  // of people and first weights
  TakeOptions take;        // how people reach in the grasp benchmark, and how the camera errs
  int trials = 0;          // of the grasp benchmark for each hand and mode; 0: 24 or 270
  std::vector<BenchmarkMode> modes;  // that it judges, with and without placement; none: see there
  std::vector<std::string> hands{thesis_hands.begin(), thesis_hands.end()};  // that it uses
};

/// An experiment with what it came to.
struct Studied {
  const Experiment* experiment = nullptr;
  Table table;
  Outcome outcome;
};

/// Repeats all experiments and judges them. Repetitions are the pieces of work that `for_each`
/// divides; the result is the same however it does.
std::vector<Studied> study(const Parts& parts, const std::vector<Experiment>& experiments,
                           const StudyOptions& options, const grasping::ForEach& for_each);

/// The grasp benchmark that is asked for: quick, direct mapping without and intelligent mapping
/// with and without placement in 24 takes each; full, every mode that the hand allows, with and
/// without, in 270 takes. The parts must outlive it.
BenchmarkRequest benchmark_of(const Parts& parts, const StudyOptions& options);

/// The hands that these need.
std::vector<std::string> hands_of(const std::vector<Experiment>& experiments);

}  // namespace prehend::mapping
