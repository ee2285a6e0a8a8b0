// Damaged conversations of DYNAMIXEL servos: whatever comes, the driver sends no more than a few
// packets, is never ready without sound places, and the emulated servos, which hear the damage,
// too, stay somewhere. What is decoded encodes to what came.
#include <utility>

#include "services/robot/core/dynamixel_driver.hpp"
#include "services/robot/core/dynamixel_emulator.hpp"
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

const std::vector<dynamixel::Servo>& servos() {
  static const auto wired = [] {
    std::string toml = "[servos]\ntorque_per_ampere = 0.5\nmax_current = 900\n";
    for (std::size_t d = 0; d < hand().dofs().size(); ++d)
      toml += "[[servo]]\nid = " + std::to_string(d + 1) + "\nzero = 500\ndof = \"" +
              hand().dofs()[d].name + "\"\n";
    return *dynamixel::parse_wiring(toml, hand(), "wiring");
  }();
  return wired;
}

constexpr Duration turn = std::chrono::milliseconds(5);

/// What driver and servos say while they are set up and led for a while.
std::string conversation() {
  return fuzz::converse(dynamixel::Emulator(hand(), servos(), {}),
                        dynamixel::Driver(hand(), {.baud = 1000000}, servos()), 200, turn);
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  fuzzer.seeds = {conversation()};
  fuzzer.mutate = [](Random& r, std::string stream) { return fuzz::mutate_bytes(r, stream); };
  fuzzer.target = [](const std::string& input) {
    fuzz::require_whole(dynamixel::Parser(), input,
                        [](const auto& packet) { return dynamixel::encode(packet); });
    dynamixel::Driver driver(hand(), {.baud = 1000000}, servos());
    dynamixel::Emulator robot(hand(), servos(), {});
    driver.connected(from_ns(0));
    bool ready = false, of_driver = false;
    int n = 0;
    for (const std::string_view part : fuzz::turns_of(input)) {
      if (std::exchange(of_driver, !of_driver)) {
        (void)robot.receive(part, turn * n);
        continue;
      }
      const std::string said = driver.step(part, from_ns(0) + turn * n++);
      fuzz::require(said.size() < 200, "says too much");
      const auto& reading = driver.reading();
      if (driver.phase() != Phase::ready) continue;
      ready = true;
      fuzz::require(!reading || reading->dof.allFinite(), "ready, but nowhere");
    }
    (void)robot.pass(std::chrono::seconds(2));
    fuzz::require(robot.measured().allFinite(), "the emulated servos are nowhere");
    return ready;
  };
  return fuzz::run(fuzzer, argc, argv);
}
