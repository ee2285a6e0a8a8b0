// What the touch of a simulated hand is worth: against the weight that it bears, against the mean
// of the solver's forces, how far an object has slid when that is noticed, and what sensing costs
// beside a step of the world. Every hand grasps every shape from the side as it is placed by its
// reach; what it does not hold is left out.
//
//   benchmark_touch [SECONDS]     of each measurement, 1
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "common/grasping/world.hpp"
#include "common/model/hand_effort.hpp"
#include "common/model/placement.hpp"
#include "services/simulation/core/touch_sense.hpp"
#include "tests/support/hands.hpp"

using namespace prehend;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

const grasping::Body bodies[] = {
    {"cylinder", {model::ShapeKind::cylinder, {0.03, 0.03, 0.15}}, 0.2, "plastic", {}},
    {"box", {model::ShapeKind::box, {0.05, 0.05, 0.15}}, 0.2, "wood", {}},
    {"sphere", {model::ShapeKind::sphere, {0.035, 0.035, 0.035}}, 0.1, "plastic", {}}};

/// A hand that has closed on a body without gravity, and has borne it for a second since; nothing:
/// it does not.
std::unique_ptr<grasping::World> holding(const model::HandModel& hand, const grasping::Body& body) {
  const auto X_OG = model::nearest_grasp(
      body.shape,
      make_pose(Vector3d::Zero(), model::grasp_axes(Vector3d::UnitX(), Vector3d::UnitY())),
      hand.reach());
  if (!X_OG) return nullptr;
  const Pose X_WO = make_pose(Vector3d(0, 0, 1)), X_WB = X_WO * *X_OG * hand.X_BG().inverse();
  VectorXd dof = hand.postures().at("open");
  auto made = grasping::World::create(
      hand, X_WB, dof, {.table = false, .gravity_W = Vector3d::Zero(), .object_damping = 20});
  if (!made || !(*made)->add_body(body, X_WO)) return nullptr;
  grasping::World& world = **made;
  if (world.distance_to_hand(0) <= 0) return nullptr;
  for (int i = 0; i < 1500; ++i) {
    for (std::size_t d = 0; d < hand.dofs().size(); ++d)
      dof[static_cast<Eigen::Index>(d)] +=
          hand.dofs()[d].closing * model::radian_of(hand.dofs()[d]) * world.time_step();
    dof = hand.clamp(dof);
    if (!world.command(X_WB, dof)) return nullptr;
    world.step();
  }
  world.set_object_damping(0);
  world.set_gravity(Vector3d(0, 0, -9.81));
  const double before = world.body_motion(0).X_WO.translation().z();
  for (int i = 0; i < 500; ++i) world.step();
  if (before - world.body_motion(0).X_WO.translation().z() > 0.01) return nullptr;
  return std::move(*made);
}

using Clock = std::chrono::steady_clock;

struct Tally {
  Clock::duration stepping{}, sensing{};
  std::vector<double> weight, noise, slid;
  int grasps = 0, slips = 0, unnoticed = 0;
};

double at(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// At rest: forces against the weight, and pads against their own mean.
void rest(grasping::World& world, simulation::TouchSense& sense, double time, Tally& tally) {
  const auto steps = static_cast<std::size_t>(time / world.time_step());
  const double weight = world.body(0).mass * 9.81;
  std::vector<std::vector<double>> told(sense.pads().size());
  for (std::size_t i = 0; i < steps; ++i) {
    const auto begin = Clock::now();
    world.step();
    const auto stepped = Clock::now();
    sense.update(world.touches(), world.base());
    tally.stepping += stepped - begin;
    tally.sensing += Clock::now() - stepped;
    if (i < steps / 10) continue;  // until the filter has filled
    Vector3d sum = Vector3d::Zero();
    for (std::size_t k = 0; k < told.size(); ++k) {
      sum += world.base().linear() * sense.pads()[k].force_B;
      told[k].push_back(sense.pads()[k].pressure);
    }
    tally.weight.push_back((sum + Vector3d(0, 0, weight)).norm() / weight);
  }
  for (const auto& pressure : told) {
    double mean = 0, squares = 0;
    for (const double p : pressure) mean += p / static_cast<double>(pressure.size());
    for (const double p : pressure)
      squares += (p - mean) * (p - mean) / static_cast<double>(pressure.size());
    if (mean > 0.5) tally.noise.push_back(std::sqrt(squares) / mean);
  }
}

/// The drives lose their strength until it slides.
void slip(grasping::World& world, simulation::TouchSense& sense, Tally& tally) {
  const VectorXd most = model::max_effort(world.hand());
  const auto X_BO = [&] { return world.base().inverse() * world.body_motion(0).X_WO; };
  const Vector3d start = X_BO().translation();
  ++tally.slips;
  for (int i = 0; i < 2500; ++i) {
    if (!world.limit_effort(most * std::max(0.0, 1 - i / 2000.0))) return;
    world.step();
    sense.update(world.touches(), world.base());
    const double slid = (X_BO().translation() - start).norm();
    const bool noticed = std::any_of(sense.pads().begin(), sense.pads().end(),
                                     [](const auto& pad) { return pad.slipping; });
    if (noticed) return tally.slid.push_back(slid);
    if (slid > 0.05) break;
  }
  ++tally.unnoticed;
}

}  // namespace

int main(int argc, char** argv) {
  const double time = argc > 1 ? std::atof(argv[1]) : 1;
  Tally all;
  const auto tell = [](const char* name, const Tally& tally) {
    fmt::print(
        "{:14} {:2} grasps; force against weight: p50 {:4.1f} %, p99 {:5.1f} %; pad against its "
        "mean, rms: p50 {:4.1f} %, worst {:5.1f} %; slid when noticed: p50 {:4.1f} mm, worst "
        "{:5.1f} mm, {} of {} within 5 mm, {} not noticed; sensing {:.1f} % of a step\n",
        name, tally.grasps, 100 * at(tally.weight, 0.5), 100 * at(tally.weight, 0.99),
        100 * at(tally.noise, 0.5), 100 * at(tally.noise, 1), 1000 * at(tally.slid, 0.5),
        1000 * at(tally.slid, 1),
        std::count_if(tally.slid.begin(), tally.slid.end(), [](double m) { return m < 0.005; }),
        tally.slips, tally.unnoticed,
        100.0 * static_cast<double>(tally.sensing.count()) /
            static_cast<double>(std::max<Clock::rep>(1, tally.stepping.count())));
  };
  for (const std::string& name : test::hand_names()) {
    Tally tally;
    for (const grasping::Body& body : bodies) {
      const auto world = holding(test::hand(name), body);
      if (!world) continue;
      simulation::TouchSense sense(world->hand().links().size(), world->time_step());
      ++tally.grasps;
      rest(*world, sense, time, tally);
      slip(*world, sense, tally);
    }
    tell(name.c_str(), tally);
    for (auto [to, from] : {std::pair(&all.weight, &tally.weight),
                            {&all.noise, &tally.noise},
                            {&all.slid, &tally.slid}})
      to->insert(to->end(), from->begin(), from->end());
    all.stepping += tally.stepping, all.sensing += tally.sensing;
    all.grasps += tally.grasps, all.slips += tally.slips, all.unnoticed += tally.unnoticed;
  }
  tell("all", all);
}
