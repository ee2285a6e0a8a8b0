#include "services/glove/core/carrying_hand.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/motion.hpp"
#include "common/model/placement.hpp"
#include "services/glove/core/mirrored_scene.hpp"

namespace prehend::glove {
namespace {

using Eigen::Vector3d;

constexpr double lifted_by = 0.12;                     // m
constexpr double beside = 0.12;                        // m, of the object, before it is touched
constexpr double pressed = 0.03;                       // m, that palms go further than they can
constexpr double waits_back = 0.2, waits_above = 0.1;  // m

}  // namespace

const std::array<CarryingHand::Step, 10> CarryingHand::presses{{
    {2.0, 0, 0, 0, 0, 0},  // rests
    {1.2, 1, 0, 0, 0, 0},
    {1.2, 1, 1, 0, 0, 0},
    {1.0, 1, 1, 0, 0, 0},
    {1.0, 1, 1, 0, 1, 0},
    {3.0, 1, 1, 0, 1, 1},
    {1.2, 1, 1, 0, 0, 1},
    {0.5, 1, 1, 0, 0, 1},
    {0.8, 1, 0, 0, 0, 1},
    {0.8, 0, 0, 0, 0, 1},
}};

/// It holds the object out until the other has had a second to hold it, too.
const std::array<CarryingHand::Step, 10> CarryingHand::gives{{
    {2.0, 0, 0, 0, 0, 0},
    {1.2, 1, 0, 0, 0, 0},
    {0.8, 1, 1, 0, 0, 0},
    {1.0, 1, 1, 1, 0, 0},
    {1.0, 1, 1, 1, 0, 0},
    {1.0, 1, 1, 1, 1, 0},
    {1.5, 1, 1, 1, 1, 0.5},
    {4.5, 1, 1, 1, 1, 0.5},
    {0.8, 1, 1, 0, 1, 0.5},
    {1.6, 0, 0, 0, 1, 0.5},
}};

const std::array<CarryingHand::Step, 11> CarryingHand::takes{{
    {8.5, 0, 0, 0, 1, 0.5},  // until it is held out
    {1.2, 1, 0, 0, 1, 0.5},
    {0.8, 1, 1, 0, 1, 0.5},
    {1.0, 1, 1, 1, 1, 0.5},
    {4.0, 1, 1, 1, 1, 0.5},  // until the other has let go
    {1.5, 1, 1, 1, 1, 1},
    {1.2, 1, 1, 1, 0, 1},
    {0.5, 1, 1, 1, 0, 1},
    {1.6, 1, 1, 0, 0, 1},
    {0.8, 1, 0, 0, 0, 1},
    {0.8, 0, 0, 0, 0, 1},
}};

double CarryingHand::cycle() const {
  double total = 0;
  for (const Step& step : steps_) total += step.lasts;
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

  const model::HumanHand hand(person.hand_scale);
  CarryingHand made(std::move(*sensors));
  made.carry_W_ = person.carry_W;
  const Pose& X_WO = target->X_WO;
  made.out_W_ = X_WO.linear().col(0);
  if (!person.hands_over) {
    made.steps_ = presses;
    const Pose X_WG = moved(X_WO * person.X_OG, -pressed * made.out_W_);
    made.X_WH_ = X_WG * hand.X_HG().inverse();
    return made;
  }
  made.again_ = false;
  Pose X_OG = person.X_OG;
  if (options.left) {
    made.steps_ = gives;
    X_OG.translation().z() *= -1;
  } else {
    made.steps_ = takes;
  }
  made.X_WH_ = X_WO * X_OG * hand.X_HG().inverse();
  made.closure_ = hand.close_on(target->shape, made.X_WH_.inverse() * X_WO);
  return made;
}

HandState CarryingHand::hand(double time) const {
  const double t_all = again_ ? std::max(time, 0.0) : std::clamp(time, 0.0, cycle());
  double t = again_ ? std::fmod(t_all, cycle()) : t_all;
  const bool back = again_ && std::fmod(t_all, 2 * cycle()) >= cycle();
  std::size_t number = 0;
  while (number + 1 < steps_.size() && t >= steps_[number].lasts) t -= steps_[number++].lasts;
  const Step& to = steps_[number];
  // Before the first it has been where that ends.
  const Step& from = number == 0 ? to : steps_[number - 1];
  const double s = minimum_jerk(t / to.lasts);
  const auto now = [&](double Step::*part) { return from.*part + s * (to.*part - from.*part); };

  const double carried = back ? 1 - now(&Step::carried) : now(&Step::carried);
  HandState state;
  state.X_WH =
      moved(X_WH_, carried * carry_W_ + now(&Step::lifted) * lifted_by * Vector3d::UnitZ() +
                       (1 - now(&Step::there)) * beside * out_W_ +
                       (1 - now(&Step::near)) *
                           (waits_above * Vector3d::UnitZ() - waits_back * Vector3d::UnitY()));
  for (std::size_t finger = 0; finger < closure_.size(); ++finger)
    state.closure[finger] = now(&Step::closed) * closure_[finger];
  return state;
}

std::optional<Frame> CarryingHand::frame(std::uint64_t n) const {
  return sensors_.frame(n, hand(sensors_.time(n)));
}

}  // namespace prehend::glove
