// Damaged conversations of a BarrettHand: whatever comes, the driver sends no more than a line or a
// block, is never ready without sound positions, and finds a sound hand again. The emulated hand
// hears the damage, too.
#include <utility>

#include "services/robot/core/barrett_driver.hpp"
#include "services/robot/core/barrett_emulator.hpp"
#include "tests/fuzz/conversation.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;
using namespace prehend::robot;

namespace {

const model::HandModel& hand() {
  static const auto loaded = model::HandModel::load(model::hand_directory("barrett"));
  return *loaded;
}

constexpr Duration turn = std::chrono::milliseconds(2);

/// What driver and hand say while it is woken, set up and led for a while.
std::string conversation(int temperature_bytes) {
  return fuzz::converse(
      barrett::Emulator(hand(), {.initialized = true, .temperature_bytes = temperature_bytes}),
      barrett::Driver(hand(), {}), 400, turn);
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  for (const int bytes : {0, 1, 2}) fuzzer.seeds.push_back(conversation(bytes));
  fuzzer.mutate = [](Random& r, std::string stream) { return fuzz::mutate_bytes(r, stream); };
  fuzzer.target = [](const std::string& input) {
    for (const std::size_t at : {std::size_t{0}, input.size() / 2}) {
      const auto reply = barrett::parse_reply(std::string_view(input).substr(at));
      for (const std::string& line : reply.lines) fuzz::require(!line.empty(), "an empty line");
    }
    barrett::Driver driver(hand(), {});
    barrett::Emulator robot(hand(), {.initialized = true});
    driver.connected(from_ns(0));
    bool ready = false, of_driver = false;
    int n = 0;
    for (const std::string_view part : fuzz::turns_of(input)) {
      if (std::exchange(of_driver, !of_driver)) {
        (void)robot.receive(part, turn * n);
        continue;
      }
      const std::string said = driver.step(part, from_ns(0) + turn * n++);
      fuzz::require(said.size() < 64, "says too much");
      if (driver.phase() == Phase::ready) {
        ready = true;
        const auto& reading = driver.reading();
        fuzz::require(reading && reading->dof.allFinite() && reading->dof.minCoeff() > -0.8 &&
                          reading->dof.maxCoeff() < 4,
                      "ready, but nowhere");
      }
    }
    fuzz::require(robot.measured().allFinite(), "the emulated hand is nowhere");
    return ready;
  };
  return fuzz::run(fuzzer, argc, argv);
}
