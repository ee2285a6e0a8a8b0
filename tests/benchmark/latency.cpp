// Glove frame read until the world has accepted the command, over two DDS hops and three processes,
// against a floor: raw Fast DDS processes that do nothing but pass messages of the same types, over
// the same two hops, with the same QoS, paced at the same rate, in the same run. Both run side by
// side in slices, so that a machine that changes its speed changes both. The floor takes the same
// way, keys and delay included.
//
//   benchmark_latency [--json] [--seconds S] [--case NAME]...     each at 30 and at 500 Hz
//
// Cases:
//   laptop       over loopback
//   containers   each process in a network space of its own on one bridge, as engines make them
//   (root) server       loopback, found through a discovery server that is started for the run
//   secure       as laptop, encrypted with keys that are made for the run
//   far          as containers, secure, and the glove is 20 ms away (root)
#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>

#include "tests/benchmark/hops.hpp"

namespace prehend {
namespace {

using hops::Case;
using hops::Place;

/// First of the floor's processes: a posture at the given rate, stamped when it is made.
int floor_source(const Place& place, double rate) {
  auto participant = hops::join(place, "floor-source", "glove");
  auto writer = *participant.writer(dds::hand_posture);
  v1::HandPosture posture;
  posture.glove("glove");
  hops::at_rate(rate, [&] {
    posture.stamp_ns(to_ns(hops::now()));
    posture.origin_ns(posture.stamp_ns());
    writer.write(posture);
  });
  return 0;
}

/// Second: a command for every posture.
int floor_relay(const Place& place) {
  auto participant = hops::join(place, "floor-relay", "mapping");
  auto writer = *participant.writer(dds::robot_command);
  auto reader = *participant.reader(dds::hand_posture);
  v2::HandCommand command;
  command.hand("hand");
  command.dof(std::vector<double>(4));
  hops::Relay<v1::HandPosture> relay([&](const v1::HandPosture& posture) {
    command.stamp_ns(posture.stamp_ns());
    command.origin_ns(posture.origin_ns());
    writer.write(command);
  });
  reader.raw().set_listener(&relay);
  hops::wait_for_the_end();
  return 0;
}

std::vector<stage::Process> start_floor(const Case& at, const Place& place, double rate) {
  std::vector<stage::Process> started;
  started.push_back(at.start("mapping", hops::floor_command("relay", rate, place)));
  started.push_back(at.start("glove", hops::floor_command("source", rate, place)));
  return started;
}

/// The real chain.
std::vector<stage::Process> start_lab(const Case& at, const Place& place, double rate) {
  std::vector<stage::Process> started;
  started.push_back(at.start_service("mapping", place, {}));
  started.push_back(at.start_service("glove", place, {fmt::format("glove.rate={}", rate)}));
  return started;
}

/// The world keeps the last 1024 latencies: a full window, begun after the start.
std::uint64_t accepted(double rate, std::size_t wanted) {
  return static_cast<std::uint64_t>(rate) + wanted;
}

}  // namespace
}  // namespace prehend

int main(int argc, char** argv) {
  using namespace prehend;
  if (const auto floor = hops::floor_of(argc, argv))
    return floor->role == "source" ? floor_source(floor->place, floor->rate)
                                   : floor_relay(floor->place);
  hops::measure(hops::plan_of(argc, argv,
                              {.seconds = 8,
                               .rates = {30, 500},
                               .cases = {"laptop", "containers", "server", "secure", "far"}}),
                start_floor, start_lab, accepted);
  return 0;
}
