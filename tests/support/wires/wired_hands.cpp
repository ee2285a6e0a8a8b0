#include "tests/support/wires/wired_hands.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "tests/support/hands.hpp"

namespace prehend::test {
namespace {

constexpr const char* wiring_file = "made.toml";

template <class T>
T must(Expected<T> made) {
  if (!made) throw std::runtime_error(made.error().message());
  return std::move(*made);
}

}  // namespace

std::string servo_wiring(const model::HandModel& hand) {
  std::string toml = "[servos]\ntorque_per_ampere = 0.5\nmax_current = 900\n";
  const std::size_t count = hand.dofs().size();
  for (std::size_t d = 0; d < count; ++d)
    toml += fmt::format("[[servo]]\nid = {}\ndof = \"{}\"\nzero = 2000\nratio = {}\n",
                        8 + count - d, hand.dofs()[d].name, d % 2 == 0 ? 1 : -2);
  return toml;
}

std::unique_ptr<robot::Driver> WiredHand::near(robot::DriverOptions options) const {
  const model::HandModel& model = test::hand(hand);
  options.wiring = servo_wiring(model);
  options.wiring_file = wiring_file;
  return must(must(robot::find_driver(driver))->create(model, options));
}

std::unique_ptr<robot::Emulator> WiredHand::far(robot::EmulatedOptions options) const {
  const model::HandModel& model = test::hand(hand);
  options.wiring = servo_wiring(model);
  options.wiring_file = wiring_file;
  return must(must(robot::find_emulator(driver))->create(model, options));
}

robot::Medium WiredHand::medium() const {
  return must(robot::find_driver(driver))->medium;
}

int WiredHand::baud() const {
  return must(robot::find_emulator(driver))->baud;
}

const std::vector<WiredHand>& wired_hands() {
  static const std::vector<WiredHand> hands{{"barrett", "barrett"},
                                            {"dynamixel", "dlr"},
                                            {"robotiq_2f85", "robotiq_2f85"},
                                            {"inspire_rh56", "inspire_rh56"},
                                            {"ros2_control", "dlr"}};
  return hands;
}

}  // namespace prehend::test
