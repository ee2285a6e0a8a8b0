#include "services/glove/core/synthetic_hand.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/motion.hpp"
#include "common/base/random.hpp"
#include "common/model/human_grasp.hpp"

namespace prehend::glove {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t sensor_count = 4;

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

Vector3d direction(Random& random) {
  while (true) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
    const Vector3d v(x, y, z);
    if (v.norm() > 0.1 && v.norm() <= 1) return v.normalized();
  }
}

}  // namespace

double SyntheticHand::cycle() {
  double total = 0;
  for (const double duration : durations) total += duration;
  return total;
}

SyntheticHand::SyntheticHand(const model::Scene& scene, const SyntheticOptions& options)
    : options_(options), person_(scene.demonstrator), hand_(scene.demonstrator.hand_scale) {
  Random random(person_.seed * 7919 + options_.seed);
  for (std::size_t s = 0; s < sensor_count; ++s) {
    const Vector3d offset = direction(random) * random.uniform(0, 0.005);
    // The back of the hand is flat and wide: its sensor sits much straighter than those on fingers.
    const double crooked = (s == 0 ? 1.5 : 10.0) * std::numbers::pi / 180;
    const AngleAxisd turn(random.uniform(0, crooked), direction(random));
    mounting_[s] = make_pose(offset, turn.toRotationMatrix());
  }
}

Expected<SyntheticHand> SyntheticHand::create(const model::Scene& scene,
                                              const model::Catalogue& catalogue,
                                              const SyntheticOptions& options) {
  if (!(options.rate >= 1 && options.rate <= 1000))
    return fail("the rate must be 1 to 1000 Hz", "synthetic hand", "set glove.rate");
  SyntheticHand made(scene, options);
  const model::Demonstrator& person = made.person_;
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
    const auto placed = std::find_if(scene.objects.begin(), scene.objects.end(),
                                     [&](const auto& o) { return o.name == person.target; });
    const model::CatalogueObject* object = catalogue.find(person.target);
    if (placed == scene.objects.end() || !object)
      return fail("the target '" + person.target + "' is not in the scene", "synthetic hand",
                  "name one of the scene's objects as demonstrator.target");
    const Pose& X_WO = placed->X_WO;
    const auto X_OG = model::human_grasp(object->shape, X_WO, person);
    if (!X_OG)
      return fail("no hand can grasp '" + person.target + "'", "synthetic hand",
                  "choose a smaller target");
    X_WG = X_WO * *X_OG;
    made.X_WH_grasp_ = X_WG * error * X_HG.inverse();
    made.closure_ = made.hand_.close_on(object->shape, made.X_WH_grasp_.inverse() * X_WO);
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
  const double time = static_cast<double>(n) / options_.rate;
  const HandState state = hand(time);
  const auto tips = hand_.fingertip_poses(model::HumanHand::posture(state.closure));
  const Pose X_TH = options_.X_WT.inverse() * state.X_WH;

  Frame result;
  result.sequence = n;
  result.stamp = Time(seconds(time));
  Random random((person_.seed * 1000003 + options_.seed) * 6364136223846793005ULL + n);
  for (std::size_t s = 0; s < sensor_count; ++s) {
    Reading reading;
    reading.site = usual_sites()[s];
    const auto finger = finger_of(reading.site);
    const Pose X_HF = finger ? tips[static_cast<std::size_t>(*finger)] : Pose::Identity();
    const Pose X_TS = X_TH * X_HF * mounting_[s];
    const Vector3d turn = random.normal3(person_.angle_noise);
    reading.p_TS = X_TS.translation() + random.normal3(person_.position_noise);
    reading.q_TS = Eigen::Quaterniond(X_TS.linear());
    if (turn.norm() > 0)
      reading.q_TS = reading.q_TS * Eigen::Quaterniond(AngleAxisd(turn.norm(), turn.normalized()));
    if (random.uniform() < person_.extreme_rate)
      reading.p_TS += direction(random) * random.uniform(0.05, 0.5);
    result.readings.push_back(reading);
  }
  return result;
}

}  // namespace prehend::glove
