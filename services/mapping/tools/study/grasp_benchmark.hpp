#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/named_values.hpp"
#include "common/grasping/planner.hpp"
#include "common/model/catalogue.hpp"
#include "services/mapping/core/mapping.hpp"
#include "services/mapping/tools/study/recorded_take.hpp"

namespace prehend::mapping {

/// The mapping that is judged. All but the last know nothing of the object; `direct` was trained on
/// exactly the pairs of `intelligent`, without shape and size.
/// What is compared: the ways to answer with the fingers, and the intelligent mapping.
enum class BenchmarkMode { direct, cartesian, retargeting, combined, intelligent };
/// In the order of reports. Named as FingerMode where they are one.
inline constexpr auto benchmark_modes = named_values<BenchmarkMode>(
    {{BenchmarkMode::direct, "direct"},
     {BenchmarkMode::cartesian, finger_modes.name(FingerMode::cartesian)},
     {BenchmarkMode::combined, finger_modes.name(FingerMode::combined)},
     {BenchmarkMode::retargeting, finger_modes.name(FingerMode::retargeting)},
     {BenchmarkMode::intelligent, "intelligent"}});
std::string_view to_string(BenchmarkMode mode);

struct BenchmarkedMode {
  BenchmarkMode mode = BenchmarkMode::direct;
  bool placement = false;  // the known object also corrects where the hand is
};

struct GraspBenchmarkOptions {
  std::vector<BenchmarkedMode> modes{{BenchmarkMode::direct}, {BenchmarkMode::intelligent, true}};
  int trials = 24;  // of each mode; grasps take turns
  /// People and takes; those of training sets are others (their seeds are small).
  std::uint64_t seed = 1'000'000'000;
  TakeOptions take;
};

/// What came of one take with one mode.
struct TrialResult {
  std::string hand, object, grasp_type, user;
  int take = 0;  // the same number is the same take, in every mode
  BenchmarkedMode mode;
  /// The robot grasp that was demonstrated survives lift and shake itself: what no mapping could
  /// hold counts for none.
  bool demonstrated_held = false;
  double joint_error = 0;  // rad², Σ over DoF of (reached − demonstrated)² [Thesis, eq. 5.1]
  double fingertip_error = 0;  // m, mean distance from the demonstrated ones, on the object
  double epsilon = -1;         // of the contacts; −1 without force closure
  double penetration = 0;      // m, deepest contact
  bool held = false;           // after lift and shake
  std::string reason;          // why not
};

/// Where hands grasp what: the pair of trained model and robot grasps. References must outlive the
/// benchmark.
struct BenchmarkedHand {
  const model::HandModel& hand;
  const MappingModel& model;
  const std::vector<RobotGrasp>& grasps;
  const model::Catalogue& catalogue;
};

/// The very mapping of the live process, in a world with the object standing on the table: glove at
/// 30 Hz, camera at 10 Hz, robot states at 100 Hz; then the hold test, shaken too. Each trial has a
/// person of its own; all modes get the same takes. The same for a seed however the work is
/// divided. Fails when the hand does not allow a mode or there is no grasp.
Expected<std::vector<TrialResult>> run_grasp_benchmark(const BenchmarkedHand& parts,
                                                       const GraspBenchmarkOptions& options,
                                                       const grasping::ForEach& for_each,
                                                       const std::function<void(double)>& progress);

}  // namespace prehend::mapping
