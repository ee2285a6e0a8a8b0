// How fast the world steps while each hand grips an object, alone and beside its like, as a
// multiple of real time at 500 Hz, and what contacts and bodies cost. A step is deterministic, so
// the figures differ by the machine alone; floors: Barrett 10, DLR 5, Robonaut 3 times real time on
// one core.
#include "common/grasping/world.hpp"

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "tests/support/hands.hpp"

namespace {

using namespace prehend;
using namespace prehend::grasping;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// So many hands, apart from each other, that have closed on a Talc each, at their grasp frames
/// moved `ahead` m along z, and squeeze.
std::unique_ptr<World> gripping(const model::HandModel& model, double ahead, int hands) {
  const auto& postures = model.postures();
  const VectorXd& preshape = postures.at(postures.contains("power") ? "power" : "open");
  const auto place = [](int hand) { return make_pose(Vector3d(hand, 0, 0.6)); };
  auto world = std::move(*World::create(model, place(0), preshape));
  for (int hand = 1; hand < hands; ++hand)
    if (!world->add_hand(model, place(hand), preshape)) throw std::runtime_error("no hand");
  world->set_gravity(Vector3d::Zero());
  world->set_object_damping(20);
  const Body talc{"Talc", {model::ShapeKind::cylinder, {0.024, 0.024, 0.105}}, 0.15, "plastic", {}};
  const Pose X_GO = make_pose(
      Vector3d(0, 0, ahead), Eigen::AngleAxisd(EIGEN_PI / 2, Vector3d::UnitY()).toRotationMatrix());
  for (int hand = 0; hand < hands; ++hand)
    if (!world->add_body(talc, world->hand_motion(hand).X_WB * model.X_BG() * X_GO))
      throw std::runtime_error("no talc");
  for (int step = 0; step < 1500; ++step) {
    for (int hand = 0; hand < hands; ++hand) {
      const VectorXd now = world->hand_motion(hand).dof;
      VectorXd command = world->commanded_dof(hand);
      for (Eigen::Index i = 0; i < command.size(); ++i) {
        const model::HandDof& dof = model.dofs()[static_cast<std::size_t>(i)];
        if (dof.closing == 0) continue;
        const double next = command[i] + dof.closing * radian_of(dof) * world->time_step();
        const double most = now[i] + dof.closing * dof.squeeze;
        command[i] = dof.closing > 0 ? std::min(next, most) : std::max(next, most);
      }
      if (!world->command(world->commanded_base(hand), model.clamp(command), Vector3d::Zero(),
                          hand))
        throw std::runtime_error("refused");
    }
    world->step();
  }
  return world;
}

void report(benchmark::State& state, const World& world, double contacts) {
  const double steps = static_cast<double>(state.iterations());
  state.counters["steps"] = benchmark::Counter(steps, benchmark::Counter::kIsRate);
  state.counters["real_time"] =
      benchmark::Counter(steps * world.time_step(), benchmark::Counter::kIsRate);
  state.counters["contacts"] = contacts;
}

void grip(benchmark::State& state, const std::string& name, int hands) {
  const std::size_t before = mallinfo2().uordblks;
  // Hands differ in where two links have it.
  std::unique_ptr<World> world;
  bool gripped = false;
  for (const double ahead : {0.0, -0.01, 0.01}) {
    world = gripping(test::hand(name), ahead, hands);
    const auto contacts = world->contacts(0);
    gripped = std::any_of(contacts.begin(), contacts.end(), [&](const auto& contact) {
      return contact.link != contacts.front().link;
    });
    if (gripped) break;
  }
  if (!gripped) return state.SkipWithError("does not grip");
  const auto memory = static_cast<double>(mallinfo2().uordblks - before);
  const auto contacts = hands * static_cast<double>(world->contacts(0).size());
  for (auto _ : state) world->step();
  report(state, *world, contacts);
  state.counters["memory_kB"] = memory / 1024;
}

/// Cubes that rest on the table, each with four contacts; the hand far above.
void bodies(benchmark::State& state) {
  const auto count = static_cast<int>(state.range(0));
  auto world = std::move(*World::create(test::hand("barrett"), make_pose(Vector3d(0, 0, 2)),
                                        test::hand("barrett").postures().at("open")));
  const Body cube{"cube", {model::ShapeKind::box, Vector3d::Constant(0.04)}, 0.05, "wood", {}};
  for (int i = 0; i < count; ++i)
    if (!world->add_body(cube, make_pose(Vector3d(0.06 * (i % 8), 0.06 * (i / 8), 0.02))))
      throw std::runtime_error("no cube");
  for (int i = 0; i < 100; ++i) world->step();
  for (auto _ : state) world->step();
  report(state, *world, 4.0 * count);
}

/// A pile of cubes in one column, so that all contacts are solved together.
void stacked(benchmark::State& state) {
  const auto count = static_cast<int>(state.range(0));
  auto world = std::move(*World::create(test::hand("barrett"), make_pose(Vector3d(1, 0, 2)),
                                        test::hand("barrett").postures().at("open")));
  const Body cube{"cube", {model::ShapeKind::box, Vector3d::Constant(0.04)}, 0.05, "wood", {}};
  for (int i = 0; i < count; ++i)
    if (!world->add_body(cube, make_pose(Vector3d(0, 0, 0.02 + 0.04 * i))))
      throw std::runtime_error("no cube");
  for (int i = 0; i < 50; ++i) world->step();
  for (auto _ : state) world->step();
  report(state, *world, 4.0 * count);
}

}  // namespace

int main(int argc, char** argv) {
  for (const std::string& name : test::hand_names())
    for (const int hands : {1, 2})
      benchmark::RegisterBenchmark(fmt::format("gripping/{}/{}", name, hands).c_str(), grip, name,
                                   hands)
          ->Unit(benchmark::kMicrosecond);
  benchmark::RegisterBenchmark("bodies", bodies)
      ->Arg(0)
      ->Arg(1)
      ->Arg(4)
      ->Arg(16)
      ->Arg(32)
      ->Unit(benchmark::kMicrosecond);
  benchmark::RegisterBenchmark("stacked", stacked)
      ->Arg(1)
      ->Arg(4)
      ->Arg(8)
      ->Arg(16)
      ->Unit(benchmark::kMicrosecond);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
