// Damaged conversations of an Inspire hand: whatever comes, the driver says one frame at a time,
// and none that moves the fingers, for nobody tells it where to go; it is never ready without sound
// places. The emulated hand, which hears the damage, too, stays somewhere. What is decoded encodes
// to what came.
#include <utility>

#include "services/robot/core/inspire_driver.hpp"
#include "services/robot/core/inspire_emulator.hpp"
#include "tests/fuzz/conversation.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;
using namespace prehend::robot;

namespace {

const model::HandModel& hand() {
  static const auto loaded = model::HandModel::load(model::hand_directory("inspire_rh56"));
  return *loaded;
}

constexpr Duration turn = std::chrono::milliseconds(6);

/// What driver and hand say when it is found, and while it is led.
std::string conversation(bool leads) {
  return fuzz::converse(inspire::Emulator(hand(), {}), inspire::Driver(hand(), {.baud = 115200}),
                        100, turn, [leads](auto& driver, int n, Time now) {
                          if (leads)
                            driver.follow(Eigen::VectorXd::Constant(6, 0.004 * n), {}, now);
                        });
}

void check_said(const std::string& said) {
  inspire::Parser parser(inspire::Side::asks);
  parser.feed(said);
  int frames = 0;
  while (const auto frame = parser.next()) {
    ++frames;
    fuzz::require(
        frame->command == inspire::Command::read || frame->address == inspire::table::clear_error,
        "the hand was told something");
  }
  fuzz::require(frames <= 1 && parser.is_empty(), "says more than one frame");
}

}  // namespace

int main(int argc, char** argv) {
  fuzz::Fuzzer fuzzer;
  fuzzer.seeds = {conversation(false), conversation(true)};
  fuzzer.mutate = [](Random& r, std::string stream) { return fuzz::mutate_bytes(r, stream); };
  fuzzer.target = [](const std::string& input) {
    for (const auto side : {inspire::Side::asks, inspire::Side::answers})
      fuzz::require_whole(inspire::Parser(side), input,
                          [side](const auto& frame) { return inspire::encode(side, frame); });
    inspire::Driver driver(hand(), {.baud = 115200});
    inspire::Emulator robot(hand(), {});
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
      fuzz::require(!driver.reading() || driver.reading()->dof.allFinite(), "ready, but nowhere");
    }
    (void)robot.pass(std::chrono::seconds(100));
    fuzz::require(robot.measured().allFinite(), "the emulated hand is nowhere");
    return ready;
  };
  return fuzz::run(fuzzer, argc, argv);
}
