// What the gate costs a command, beside what comes before it anyway: turning the message's poses
// and joints into values. One thread.
#include <benchmark/benchmark.h>

#include <cstdlib>

#include "common/convert/convert.hpp"
#include "common/gate/command_gate.hpp"
#include "common/model/hand_effort.hpp"
#include "idl/Robot.h"
#include "tests/support/hands.hpp"

using namespace prehend;

namespace {

const Time start = from_ns(1'700'000'000'000'000'000);

v2::HandCommand message_for(const model::HandModel& hand) {
  v2::HandCommand message;
  message.hand("hand");
  message.model(hand.name().c_str());
  message.dof(convert::to_message(hand.postures().at("open")));
  message.effort(convert::to_message(model::max_effort(hand)));
  message.X_WB(convert::to_message(make_pose(Eigen::Vector3d(0, 0, 0.5))));
  return message;
}

const model::HandModel& hand_of(const benchmark::State& state) {
  return test::hand(state.range(0) == 0 ? "barrett" : "human");
}

void conversion(benchmark::State& state) {
  const v2::HandCommand message = message_for(hand_of(state));
  for (auto _ : state) {
    benchmark::DoNotOptimize(convert::from_message(message.dof()));
    benchmark::DoNotOptimize(convert::from_message(message.effort()));
    benchmark::DoNotOptimize(convert::from_message(message.X_WB()));
  }
}

gate::Command command_for(const model::HandModel& hand) {
  return {
      {},
      0,
      start,
      "hand",
      hand.name(),
      {hand.postures().at("open"), make_pose(Eigen::Vector3d(0, 0, 0.5)), model::max_effort(hand)}};
}

/// A sound stream at 1 kHz: each command passes.
void admit(benchmark::State& state) {
  const model::HandModel& hand = hand_of(state);
  auto gate = gate::CommandGate::create(hand, {.hand = "hand"}, gate::limits_of(hand)).value();
  gate::Command command = command_for(hand);
  for (auto _ : state) {
    ++command.sequence;
    command.stamp += std::chrono::milliseconds(1);
    command.place.X_WB.translation().x() += command.sequence % 2000 < 1000 ? 1e-4 : -1e-4;
    if (!gate.admit(command, command.stamp)) std::abort();
  }
}

/// One writer too many: each command is refused.
void refuse(benchmark::State& state) {
  const model::HandModel& hand = hand_of(state);
  auto gate = gate::CommandGate::create(hand, {.hand = "hand"}, gate::limits_of(hand)).value();
  gate::Command command = command_for(hand);
  if (!gate.admit(command, start)) std::abort();
  command.writer[0] = 1;
  for (auto _ : state) {
    ++command.sequence;
    if (gate.admit(command, start)) std::abort();
  }
}

BENCHMARK(conversion)->ArgName("fingers")->Arg(0)->Arg(1);
BENCHMARK(admit)->ArgName("fingers")->Arg(0)->Arg(1);
BENCHMARK(refuse)->ArgName("fingers")->Arg(0)->Arg(1);

}  // namespace

BENCHMARK_MAIN();
