// One frame through the mapping: latency of each as p50 and p99. Networks of random weights take as
// long as trained ones. Aims: p99 below 10 µs without an object, below 30 µs with nine in sight,
// also with planned grasps for all of them. Vector retargeting, today's baseline, runs beside them.
#include "services/mapping/core/mapping.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "common/model/placement.hpp"
#include "tests/support/hands.hpp"
#include "tests/support/models/random_model.hpp"

namespace {

using namespace prehend;
using namespace prehend::mapping;

constexpr int hidden = 16;  // as trained ones have

/// Who also follows planned grasps: how far a person has closed is a network's answer.
MappingModel following(const model::HandModel& hand) {
  const MappingModel plain = test::random_model(hand, 1, hidden);
  const int inputs = feature_count + size_count(SizeInput::seen, model::ShapeKind::unknown);
  ModelTraits traits = plain.traits();
  traits.closing =
      MappingNetwork{model::ShapeKind::unknown,
                     *learning::Network::create({learning::Layer::Constant(hidden, inputs + 1, 0.3),
                                                 learning::Layer::Constant(1, hidden + 1, 0.3)}),
                     *learning::Scaling::create(Eigen::VectorXd::Constant(inputs, -0.2),
                                                Eigen::VectorXd::Constant(inputs, 0.2)),
                     *learning::Scaling::create(Eigen::VectorXd::Zero(1), Eigen::VectorXd::Ones(1)),
                     {}};
  return *MappingModel::create(hand, traits, plain.networks());
}

/// As many as a message holds, the surest first; only the last one comes from X_OG, the others lean
/// away from there.
model::GraspCandidates planned(const model::HandModel& hand, std::uint32_t track,
                               const model::Shape& shape, const Pose& X_OG) {
  constexpr int count = 16;
  model::GraspCandidates all{track, shape, {}};
  for (int i = 0; i < count; ++i) {
    const Eigen::AngleAxisd lean(0.5 * (count - 1 - i), Eigen::Vector3d::UnitY());
    const Pose from = X_OG * make_pose(Eigen::Vector3d::Zero(), lean.toRotationMatrix());
    const Eigen::VectorXd open = hand.postures().at("open");
    all.candidates.push_back({from, from, open, hand.clamp((open.array() + 0.5).matrix()),
                              Eigen::VectorXd::Ones(open.size()), 0.9 - 0.01 * i});
  }
  return all;
}

/// A hand near nine objects that closes and opens, a frame every 33 ms.
void frames(benchmark::State& state, const std::string& name, FingerMode fingers, bool intelligent,
            bool follows) {
  const model::HandModel& model = test::hand(name);
  const MappingModel networks = follows ? following(model) : test::random_model(model, 1, hidden);
  Mapping mapping =
      *Mapping::create(model, networks, {.modes = {fingers, intelligent, intelligent}});
  const model::Shape thin{model::ShapeKind::cylinder, {0.015, 0.015, 0.145}};
  const Pose X_WO = make_pose({0, 0, 0.0725});
  Eigen::Matrix3d from_the_side;
  from_the_side << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  const Pose X_WG = make_pose({0, 0, 0.0725}, from_the_side);
  const model::HumanHand person(1);
  const auto joints = static_cast<Eigen::Index>(model.joints().size());
  const RobotState open{Time(seconds(1)), model.postures().at("open"),
                        Eigen::VectorXd::Zero(joints), Eigen::VectorXd::Zero(joints),
                        X_WG * model.X_BG().inverse()};
  if (!mapping.on_state(open)) throw std::runtime_error("no state");

  const auto X_OG = model::nearest_grasp(thin, X_WO.inverse() * X_WG, model.reach());
  for (std::uint32_t track = 0; follows && track < 9; ++track)
    if (!X_OG || !mapping.on_candidates(planned(model, track, thin, *X_OG)))
      throw std::runtime_error("no candidates");

  std::vector<double> took;
  int frame = 0;
  double weight = 0;
  for (auto _ : state) {
    const Time now = Time(seconds(1 + ++frame / 30.));
    const double c = 0.5 - 0.5 * std::cos(0.1 * frame);
    const auto tips = person.fingertip_poses(model::HumanHand::posture({c, c, c, c, c}));
    Posture posture{now, now, X_WG * person.X_HG().inverse(), 1, {}};
    for (std::size_t f = 0; f < tips.size(); ++f)
      posture.fingertips[f] = {true, tips[f].translation()};
    for (std::uint32_t track = 0; track < 9; ++track)
      (void)mapping.on_detection({track, "object", thin, X_WO, 0.9, now});
    const auto begin = std::chrono::steady_clock::now();
    const auto command = mapping.on_posture(posture, now);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
    if (!command) throw std::runtime_error(command.error().message());
    weight = command->weight;
    took.push_back(elapsed.count());
    state.SetIterationTime(elapsed.count());
  }
  std::sort(took.begin(), took.end());
  state.counters["p50_us"] = 1e6 * took[took.size() / 2];
  state.counters["p99_us"] = 1e6 * took[took.size() * 99 / 100];
  state.counters["weight"] = weight;
}

}  // namespace

int main(int argc, char** argv) {
  for (const char* name : {"barrett", "dlr", "robonaut"})
    for (const auto& [label, fingers, intelligent, follows] :
         {std::tuple("direct", FingerMode::joints, false, false),
          std::tuple("intelligent", FingerMode::joints, true, false),
          std::tuple("planned", FingerMode::joints, true, true),
          std::tuple("cartesian", FingerMode::cartesian, false, false),
          std::tuple("retargeting", FingerMode::retargeting, false, false)})
      benchmark::RegisterBenchmark(
          (std::string(name) + "/" + label).c_str(),
          [=, mode = fingers, known = intelligent, candidates = follows](auto& state) {
            frames(state, name, mode, known, candidates);
          })
          ->UseManualTime()
          ->Iterations(20000)
          ->Unit(benchmark::kMicrosecond);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
}
