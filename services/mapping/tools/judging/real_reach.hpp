#pragma once

#include <optional>
#include <vector>

#include "services/mapping/tools/judging/grasp_benchmark.hpp"
#include "services/mapping/tools/judging/real_take.hpp"

/// Takes of real people, who were recorded without an object: it is put where their fingers close.
namespace prehend::mapping {

/// Fingers of a real hand that close: frames of its recording, from the most open to the most
/// closed.
struct RealClosing {
  const RealTake* take = nullptr;
  std::size_t open = 0, closed = 0;
  /// m, thumb tip to the middle of index and middle finger's, widest and narrowest.
  double open_span = 0, closed_span = 0;
  bool pinch = false;  // ring and little finger stay out of it
};

/// All closings of a recording: the span falls by 4 cm within 3 s, and the index finger bends.
/// Keeps references to it.
std::vector<RealClosing> closings_of(const RealTake& take);

/// How an object was put into such a hand, and what of it is a guess.
struct Placed {
  Pose X_GG;               // of the person's own grasp frame in that which gloves suppose
  std::size_t touch = 0;   // the frame in which its fingers are as far apart as it is wide
  double off_surface = 0;  // m, rms of the tips that touch from its surface
  double off_axis = 0;     // rad, of thumb to fingers from where gloves suppose it
};

/// Puts the object of a grasp between the fingertips: its middle between thumb and fingers, its
/// faces across the line from one to the other; a wrapped one as deep in the hand as gloves
/// suppose. None where the fingers do not open so wide or do not close so far, where pinch and wrap
/// do not agree, or where the line is more than 45° off.
std::optional<Placed> place_object(const RealClosing& closing, const RobotGrasp& grasp);

/// Reaches as synthetic people do, closes with these fingers at their own pace, and keeps them
/// closed. The user says who, when, and how far off the object is from the fingertips.
RecordedTake real_reach(const RealClosing& closing, const RobotGrasp& grasp, const Placed& placed,
                        const TakeOptions& options);

/// For each grasp that any closing fits, the `each` that fit best, numbered from `first` on.
std::vector<BenchmarkTake> real_takes(const std::vector<RealTake>& people,
                                      const std::vector<RobotGrasp>& grasps, int each, int first,
                                      const TakeOptions& options);

}  // namespace prehend::mapping
