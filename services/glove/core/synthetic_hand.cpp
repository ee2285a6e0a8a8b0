#include "services/glove/core/synthetic_hand.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/motion.hpp"
#include "common/model/human_grasp.hpp"
#include "services/glove/core/mirrored_scene.hpp"

namespace prehend::glove {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

/// What the hand does and for how long, s.
enum Phase {
  rest,
  reach,
  enter,
  close,
  hold,
  lift,
  carry,
  lower,
  release,
  leave,
  go_back,
  phase_count
};
constexpr std::array<double, phase_count> durations{2.0, 1.0, 0.7, 1.0, 2.5, 0.8,
                                                    0.6, 0.8, 0.5, 0.5, 0.6};
constexpr double lift_height = 0.12;                   // m
constexpr double approach_path = 0.12;                 // m, straight in
constexpr double rest_back = 0.25, rest_above = 0.20;  // m

}  // namespace

double SyntheticHand::cycle() {
  double total = 0;
  for (const double duration : durations) total += duration;
  return total;
}

Expected<SyntheticHand> SyntheticHand::create(const model::Scene& room,
                                              const model::Catalogue& catalogue,
                                              const SyntheticOptions& options) {
  const model::Scene scene = options.left ? mirrored(room, options.X_WT) : room;
  const model::Demonstrator& person = scene.demonstrator;
  auto sensors = WornSensors::create(person, options);
  if (!sensors) return tl::unexpected(sensors.error());
  SyntheticHand made(std::move(*sensors), person.hand_scale);
  const Pose X_HG = made.hand_.X_HG();
  Pose X_WG =
      make_pose(Vector3d(0, 0, 0.10), model::grasp_axes(-Vector3d::UnitY(), Vector3d::UnitX()));
  const Pose error = make_pose(
      person.approach_offset,
      AngleAxisd(person.approach_turn.norm(), person.approach_turn.norm() > 0
                                                  ? Vector3d(person.approach_turn.normalized())
                                                  : Vector3d::UnitX().eval())
          .toRotationMatrix());
  if (person.target.empty()) {
    made.X_WH_grasp_ = X_WG * error * X_HG.inverse();
    made.closure_.fill(0.5);
  } else {
    const auto target = target_of(scene, catalogue);
    if (!target) return tl::unexpected(target.error());
    const Pose& X_WO = target->X_WO;
    const auto X_OG = model::human_grasp(target->shape, X_WO, person);
    if (!X_OG)
      return fail("no hand can grasp '" + person.target + "'", "synthetic hand",
                  "choose a smaller target");
    X_WG = X_WO * *X_OG;
    made.X_WH_grasp_ = X_WG * error * X_HG.inverse();
    made.closure_ = made.hand_.close_on(target->shape, made.X_WH_grasp_.inverse() * X_WO);
  }
  const Vector3d approach = X_WG.linear().col(2);
  // From above, «back» is where the arm comes from: behind the wrist.
  Vector3d back = -approach;
  if (std::abs(approach.z()) > 0.7) back = -X_WG.linear().col(1);
  back.z() = 0;
  made.X_WH_before_ = moved(made.X_WH_grasp_, -approach_path * approach);
  made.X_WH_rest_ =
      moved(made.X_WH_grasp_, rest_back * back.normalized() + rest_above * Vector3d::UnitZ());
  return made;
}

HandState SyntheticHand::hand(double time) const {
  double t = std::fmod(std::max(time, 0.0), cycle());
  int phase = 0;
  while (phase + 1 < phase_count && t >= durations[phase]) t -= durations[phase++];
  const double s = minimum_jerk(t / durations[phase]);

  double closed = 0, lifted = 0;
  Pose X_WH = X_WH_grasp_;
  switch (phase) {
    case rest:
      X_WH = X_WH_rest_;
      break;
    case reach:
      X_WH = interpolate(X_WH_rest_, X_WH_before_, s);
      break;
    case enter:
      X_WH = interpolate(X_WH_before_, X_WH_grasp_, s);
      break;
    case close:
      closed = s;
      break;
    case hold:
      closed = 1;
      break;
    case lift:
      closed = 1, lifted = s;
      break;
    case carry:
      closed = 1, lifted = 1;
      break;
    case lower:
      closed = 1, lifted = 1 - s;
      break;
    case release:
      closed = 1 - s;
      break;
    case leave:
      X_WH = interpolate(X_WH_grasp_, X_WH_before_, s);
      break;
    default:
      X_WH = interpolate(X_WH_before_, X_WH_rest_, s);
  }
  HandState state;
  state.X_WH = moved(X_WH, lifted * lift_height * Vector3d::UnitZ());
  for (int f = 0; f < model::finger_count; ++f) state.closure[f] = closed * closure_[f];
  return state;
}

std::optional<Frame> SyntheticHand::frame(std::uint64_t n) const {
  return sensors_.frame(n, hand(sensors_.time(n)));
}

}  // namespace prehend::glove
