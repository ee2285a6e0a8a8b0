#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/named_values.hpp"
#include "common/grasping/catalogue_bodies.hpp"
#include "common/grasping/planner.hpp"
#include "services/mapping/tools/judging/answerer.hpp"
#include "services/mapping/tools/judging/recorded_take.hpp"

namespace prehend::mapping {

/// The mapping that is judged: the ways to answer with the fingers, which know nothing of the
/// object, the intelligent mapping, the same with planned grasps, and somebody else's. `direct` was
/// trained on exactly the pairs of `intelligent`, without shape and size.
enum class BenchmarkMode {
  direct,
  cartesian,
  retargeting,
  combined,
  intelligent,
  planned,
  external
};
/// In the order of reports. Named as FingerMode where they are one.
inline constexpr auto benchmark_modes = named_values<BenchmarkMode>(
    {{BenchmarkMode::direct, "direct"},
     {BenchmarkMode::cartesian, finger_modes.name(FingerMode::cartesian)},
     {BenchmarkMode::combined, finger_modes.name(FingerMode::combined)},
     {BenchmarkMode::retargeting, finger_modes.name(FingerMode::retargeting)},
     {BenchmarkMode::intelligent, "intelligent"},
     {BenchmarkMode::planned, "planned"},
     {BenchmarkMode::external, "external"}});
std::string_view to_string(BenchmarkMode mode);

struct BenchmarkedMode {
  BenchmarkMode mode = BenchmarkMode::direct;
  bool placement = false;  // the known object also corrects where the hand is
};

/// The numbers 0 .. count − 1.
std::vector<int> first_takes(int count);

struct GraspBenchmarkOptions {
  /// Each answers all takes.
  std::vector<BenchmarkedMode> modes{{BenchmarkMode::direct}, {BenchmarkMode::intelligent, true}};
  std::vector<int> takes = first_takes(24);  // with each mode; grasps take turns
  /// People and takes; those of training sets are others (their seeds are small).
  std::uint64_t seed = 1'000'000'000;
  /// How people reach, and how the camera errs.
  TakeOptions take;
};

/// What came of one take with one mode.
struct TrialResult {
  std::string hand, object, grasp_type, user;
  int take = 0;       // the same number is the same take, in every mode
  bool real = false;  // of a real person, at an object that was put into the hand
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
  const grasping::CatalogueBodies& objects;
};

/// One take with the grasp of the robot hand that it was shown for.
struct BenchmarkTake {
  int number = 0;
  RobotGrasp grasp;
  RecordedTake recorded;
  bool real = false;  // see real_reach.hpp
};

/// The take of this number: grasps take turns, people follow from the seed. None where no person's
/// hand fits around the object.
std::optional<BenchmarkTake> make_take(const std::vector<RobotGrasp>& grasps,
                                       const GraspBenchmarkOptions& options, int number);

/// What the camera says of the take's object, wherever that is now.
Detection seen_object(const BenchmarkTake& take, const Pose& X_WO, Time now);

/// What a mode is as our own mapping.
MappingOptions mapping_options(const BenchmarkedMode& mode);

/// Plays the take to whoever answers, in a world with the object standing on the table: glove at
/// 30 Hz, camera at 10 Hz, robot states at 100 Hz. Commands go through the gate that stands before
/// every robot hand. Then comes the hold test, shaken too. Fails when there can be no such world.
Expected<TrialResult> judge_take(const BenchmarkedHand& parts, const BenchmarkTake& take,
                                 const BenchmarkedMode& mode, Answerer& answerer);

/// Told of each take and mode as it is done, by the threads that do the work, one at a time. No
/// result: no person's hand fits there.
using OnTrial =
    std::function<void(const BenchmarkedMode&, int take, const std::optional<TrialResult>&)>;

/// Fails when the hand does not allow the mode.
Expected<void> check_mode(const BenchmarkedHand& parts, const BenchmarkedMode& mode);

/// The very mapping of the live process, judged by takes. Each has a person of its own; all modes
/// get the same. The same for a seed however the work is divided. Fails when the hand does not
/// allow a mode or there is no grasp.
Expected<std::vector<TrialResult>> run_grasp_benchmark(const BenchmarkedHand& parts,
                                                       const GraspBenchmarkOptions& options,
                                                       const grasping::ForEach& for_each,
                                                       const OnTrial& on_trial = {});

}  // namespace prehend::mapping
