#include "services/glove/core/carrying_hand.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/motion.hpp"
#include "common/model/placement.hpp"
#include "services/glove/core/mirrored_scene.hpp"

namespace prehend::glove {
namespace {

using Eigen::Vector3d;

/// What the hand does and for how long, s.
enum class Step { rest, reach, press, hold, lift, carry, lower, stand, release, go_back };
constexpr std::array<double, 10> step_lasts{2.0, 1.2, 1.2, 1.0, 1.0, 3.0, 1.2, 0.5, 0.8, 0.8};
constexpr double lifted_by = 0.12;                     // m
constexpr double beside = 0.12;                        // m, of the object, before it is pressed
constexpr double pressed = 0.03;                       // m, that palms go further than they can
constexpr double waits_back = 0.2, waits_above = 0.1;  // m

}  // namespace

double CarryingHand::cycle() {
  double total = 0;
  for (const double duration : step_lasts) total += duration;
  return total;
}

Expected<CarryingHand> CarryingHand::create(const model::Scene& room,
                                            const model::Catalogue& catalogue,
                                            const SyntheticOptions& options) {
  const model::Scene scene = options.left ? mirrored(room, options.X_WT) : room;
  const model::Demonstrator& person = scene.demonstrator;
  auto sensors = WornSensors::create(person, options);
  if (!sensors) return tl::unexpected(sensors.error());
  const auto target = target_of(scene, catalogue);
  if (!target) return tl::unexpected(target.error());

  CarryingHand made(std::move(*sensors));
  made.carry_W_ = person.carry_W;
  const Pose& X_WO = target->X_WO;
  made.out_W_ = X_WO.linear().col(0);
  const Pose X_WG = moved(X_WO * person.X_OG, -pressed * made.out_W_);
  made.X_WH_ = X_WG * model::HumanHand(person.hand_scale).X_HG().inverse();
  return made;
}

HandState CarryingHand::hand(double time) const {
  const double t_all = std::max(time, 0.0);
  double t = std::fmod(t_all, cycle());
  const bool back = std::fmod(t_all, 2 * cycle()) >= cycle();
  std::size_t number = 0;
  while (number + 1 < step_lasts.size() && t >= step_lasts[number]) t -= step_lasts[number++];
  const Step step = static_cast<Step>(number);
  const double s = minimum_jerk(t / step_lasts[number]);
  const auto between = [&](Step begins, Step ends) {  // 1; 0 before and after
    if (step == begins) return s;
    if (step == ends) return 1 - s;
    return step > begins && step < ends ? 1.0 : 0.0;
  };
  const double near = between(Step::reach, Step::go_back);
  const double closed = between(Step::press, Step::release);
  const double lifted = between(Step::lift, Step::lower);
  const double there = step < Step::carry ? 0 : step == Step::carry ? s : 1;
  const double carried = back ? 1 - there : there;
  return {.X_WH = moved(X_WH_, carried * carry_W_ + lifted * lifted_by * Vector3d::UnitZ() +
                                   (1 - closed) * beside * out_W_ +
                                   (1 - near) * (waits_above * Vector3d::UnitZ() -
                                                 waits_back * Vector3d::UnitY()))};
}

std::optional<Frame> CarryingHand::frame(std::uint64_t n) const {
  return sensors_.frame(n, hand(sensors_.time(n)));
}

}  // namespace prehend::glove
