// Damaged conversations of a Robotiq gripper: whatever comes, the driver says one question at a
// time, and never one that moves the fingers, for nobody tells it where to go or lets it home; it
// is never ready without a sound place. The emulated gripper, which hears the damage, too, stays
// somewhere. What is decoded encodes to what came.
#include <utility>

#include "services/robot/core/robotiq_driver.hpp"
#include "services/robot/core/robotiq_emulator.hpp"
#include "tests/fuzz/conversation.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;
using namespace prehend::robot;

namespace {

const model::HandModel& hand() {
  static const auto loaded = model::HandModel::load(model::hand_directory("robotiq_2f85"));
  return *loaded;
}

constexpr Duration turn = std::chrono::milliseconds(6);

robotiq::Driver make_driver() {
  return {hand(), {.baud = 115200}, robotiq::kind_2f85};
}
robotiq::Emulator make_gripper() {
  return {hand(), robotiq::kind_2f85, {.initialized = true}};
}

/// What driver and gripper say when it is found, and while it is led.
std::string conversation(bool leads) {
  return fuzz::converse(make_gripper(), make_driver(), 100, turn,
                        [leads](auto& driver, int n, Time now) {
                          if (leads)
                            driver.follow(Eigen::VectorXd::Constant(1, 0.005 * n), {}, now);
                        });
}

void check_said(const std::string& said) {
  modbus::Parser parser(modbus::Side::asks);
  parser.feed(said);
  int frames = 0;
  while (const auto frame = parser.next()) {
    ++frames;
    const bool writes = frame->function == static_cast<std::uint8_t>(modbus::Function::write);
    fuzz::require(!writes || (frame->data[5] & robotiq::goes) == 0, "the fingers were told to go");
  }
  fuzz::require(frames <= 1 && parser.is_empty(), "says more than one question");
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  fuzzer.seeds = {conversation(false), conversation(true)};
  fuzzer.mutate = [](Random& r, std::string stream) { return fuzz::mutate_bytes(r, stream); };
  fuzzer.target = [](const std::string& input) {
    for (const auto side : {modbus::Side::asks, modbus::Side::answers})
      fuzz::require_whole(modbus::Parser(side), input,
                          [](const auto& frame) { return modbus::encode(frame); });
    robotiq::Driver driver = make_driver();
    robotiq::Emulator robot = make_gripper();
    driver.connected(from_ns(0));
    bool ready = false, of_driver = false;
    int n = 0;
    for (const std::string_view part : fuzz::turns_of(input)) {
      if (std::exchange(of_driver, !of_driver)) {
        (void)robot.receive(part, turn * n);
        continue;
      }
      check_said(driver.step(part, from_ns(0) + turn * n++));
      if (driver.phase() != Phase::ready) continue;
      ready = true;
      fuzz::require(driver.reading() && driver.reading()->dof.allFinite(), "ready, but nowhere");
    }
    (void)robot.pass(std::chrono::seconds(100));
    fuzz::require(robot.measured().allFinite(), "the emulated gripper is nowhere");
    return ready;
  };
  return fuzz::run(fuzzer, argc, argv);
}
