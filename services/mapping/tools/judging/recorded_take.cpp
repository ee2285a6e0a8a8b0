#include "services/mapping/tools/judging/recorded_take.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "common/base/random.hpp"

namespace prehend::mapping {

namespace {

using Eigen::Vector3d;

constexpr double start = 0.25;    // m, before the grasp, along the approach
constexpr double reaching = 1.6;  // s, to get there
constexpr double pause = 0.2;     // s, before the fingers close
static_assert(reaching + pause == reach_time);
constexpr double closing = 0.8;  // s
constexpr double extra = 0.05;   // of a finger's closure, by which it presses on

/// From 0 to 1 as people move: without a jerk at the ends.
double smooth(double share) {
  return 0.5 * (1 - std::cos(std::numbers::pi * std::clamp(share, 0.0, 1.0)));
}

}  // namespace

Pose approach_at(double t) {
  return make_pose(Vector3d(0, 0, -start * (1 - smooth(t / reaching))));
}

void see_object(RecordedTake& take, const model::Shape& shape, std::uint64_t seed,
                const TakeOptions& options) {
  Random camera(seed ^ 0xca3e7a);
  const double sign = camera.uniform() < 0.5 ? -1 : 1;
  take.seen_shape = shape;
  take.seen_shape.size *= 1 + sign * options.size_error;
  const double x = camera.normal(options.position_error);
  const double y = camera.normal(options.position_error);
  const double turn = camera.normal(options.angle_error);
  // It is known to stand on the table: its middle is as high as it seems half high.
  const double higher = half_extents(take.seen_shape).z() - half_extents(shape).z();
  take.X_OS = make_pose(Vector3d(x, y, higher),
                        Eigen::AngleAxisd(turn, Vector3d::UnitZ()).toRotationMatrix());
  take.covariance.setZero();
  if (options.says_uncertain) {
    const double claimed = std::max(options.position_error, options.claimed_error);
    take.covariance(0, 0) = take.covariance(1, 1) = claimed * claimed;
    take.covariance(3, 3) = options.angle_error * options.angle_error;
  }
}

std::optional<RecordedTake> record_take(const RobotGrasp& grasp, std::uint64_t seed,
                                        const TakeOptions& options) {
  Demonstrator person(fmt::format("test person {}", seed), seed, options.demonstrator);
  const auto reached = person.reach(grasp.shape, grasp.X_OG, grasp.type);
  if (!reached) return std::nullopt;

  person.rest();
  RecordedTake take;
  take.user = person.user();
  take.X_WO = make_pose(Vector3d(0, 0, half_extents(grasp.shape).z()));
  take.X_WG = take.X_WO * reached->X_OG;
  take.closure = reached->closure;
  take.closed = Time(seconds(reach_time + closing));
  const auto last = static_cast<int>((reach_time + closing + keep_time) * glove_rate);
  for (int frame = 0; frame <= last; ++frame) {
    const double t = frame / glove_rate;
    const Pose X_WG = take.X_WG * approach_at(t);
    const double closed = smooth((t - reaching - pause) / closing);
    Closure closure;
    for (std::size_t f = 0; f < closure.size(); ++f)
      closure[f] = closed * (take.closure[f] + extra);
    Posture posture;
    posture.stamp = posture.origin = Time(seconds(t));
    // The glove takes its sensor's place for the hand's, and the scale that was calibrated.
    posture.X_WH = X_WG * person.hand().X_HG().inverse() * person.X_HR();
    posture.hand_scale = person.calibrated_scale();
    const double ready = options.late ? closed : smooth(t / reaching);
    posture.fingertips = person.sense(closure, 0, 1 - ready);
    take.postures.push_back(posture);
  }
  see_object(take, grasp.shape, seed, options);
  return take;
}

}  // namespace prehend::mapping
