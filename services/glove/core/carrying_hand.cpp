#include "services/glove/core/carrying_hand.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/motion.hpp"
#include "services/glove/core/mirrored_scene.hpp"

namespace prehend::glove {
namespace {

using Eigen::Vector3d;

/// What the hand does and for how long, s.
enum Phase { rest, reach, press, hold, lift, carry, lower, stand, release, go_back, phase_count };
constexpr std::array<double, phase_count> durations{2.0, 1.2, 1.2, 1.0, 1.0,
                                                    3.0, 1.2, 0.5, 0.8, 0.8};
constexpr double lift_height = 0.12;                 // m
constexpr double beside = 0.12;                      // m, of the object, before it is pressed
constexpr double pressed = 0.03;                     // m, that palms go further than they can
constexpr double rest_back = 0.2, rest_above = 0.1;  // m

}  // namespace

double CarryingHand::cycle() {
  double total = 0;
  for (const double duration : durations) total += duration;
  return total;
}

Expected<CarryingHand> CarryingHand::create(const model::Scene& room,
                                            const model::Catalogue& catalogue,
                                            const SyntheticOptions& options) {
  const model::Scene scene = options.left ? mirrored(room, options.X_WT) : room;
  const model::Demonstrator& person = scene.demonstrator;
  auto sensors = WornSensors::create(person, options);
  if (!sensors) return tl::unexpected(sensors.error());
  const auto placed =
      std::find_if(scene.objects.begin(), scene.objects.end(),
                   [&](const auto& object) { return object.name == person.target; });
  const model::CatalogueObject* object = catalogue.find(person.target);
  if (placed == scene.objects.end() || !object)
    return fail("the target '" + person.target + "' is not in the scene", "synthetic hand",
                "name one of the scene's objects as demonstrator.target");

  CarryingHand made(std::move(*sensors));
  made.carry_W_ = person.carry_W;
  const Pose& X_WO = placed->X_WO;
  const double half = X_WO.linear().row(0).cwiseAbs().dot(model::half_extents(object->shape));
  const Vector3d p_WG =
      X_WO.translation() + (half - person.reach.engage - pressed) * Vector3d::UnitX();
  // Fingers forward, thumb up, the palm towards the object.
  Eigen::Matrix3d R_WH;
  R_WH << Vector3d::UnitY(), Vector3d::UnitZ(), Vector3d::UnitX();
  const Vector3d p_HG = model::HumanHand(person.hand_scale).X_HG().translation();
  made.X_WH_ = make_pose(p_WG - R_WH * p_HG, R_WH);
  return made;
}

HandState CarryingHand::hand(double time) const {
  const double t_all = std::max(time, 0.0);
  double t = std::fmod(t_all, cycle());
  const bool back = std::fmod(t_all, 2 * cycle()) >= cycle();
  int phase = 0;
  while (phase + 1 < phase_count && t >= durations[phase]) t -= durations[phase++];
  const double s = minimum_jerk(t / durations[phase]);
  // How far each has come when the phase began, and what it adds.
  const auto in = [&](Phase begins, Phase ends) {  // 0 before, 1 between, 0 again
    if (phase == begins) return s;
    if (phase == ends) return 1 - s;
    return phase > begins && phase < ends ? 1.0 : 0.0;
  };
  const double near = in(reach, go_back), closed = in(press, release), lifted = in(lift, lower);
  const double there = phase < carry ? 0 : phase == carry ? s : 1;
  const double carried = back ? 1 - there : there;
  return {.X_WH = moved(X_WH_, carried * carry_W_ + lifted * lift_height * Vector3d::UnitZ() +
                                   (1 - closed) * beside * Vector3d::UnitX() +
                                   (1 - near) * (rest_above * Vector3d::UnitZ() -
                                                 rest_back * Vector3d::UnitY()))};
}

std::optional<Frame> CarryingHand::frame(std::uint64_t n) const {
  return sensors_.frame(n, hand(sensors_.time(n)));
}

}  // namespace prehend::glove
