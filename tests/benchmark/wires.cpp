// What real hands' drivers do at the end of a wire.
//
//   benchmark_wires [--json] [--rates [--driver NAME] [--seconds S]] [--faults]
//
// Without a word: both tables.
//
// Rates: how many rounds a second each driver makes at each baud that its device may be set to: a
// round tells what the hand shall do and reads all joints. The driver is that of prehend-robot in
// its tick of 2 ms, the hand is emulated, and the pseudo-terminal between them is paced both ways.
// The floor: the bytes of such a round, one after the other, at that baud.
//
// Faults: each fault of `prehend robot emulate` with each driver, in computed time: after how many
// seconds the hand is named unready, stands still, and is ready again after the fault's end.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>

#include "tests/support/wires/fault_play.hpp"
#include "tests/support/wires/paced_line.hpp"

namespace prehend {
namespace {

/// A hand, and the speeds of its line, bits per second.
struct Speeds {
  test::WiredHand wired;
  std::vector<int> bauds;
};

std::vector<Speeds> all_speeds() {
  const std::vector<int> servos{9600, 57600, 115200, 1'000'000, 2'000'000, 3'000'000, 4'000'000};
  return {{{"barrett", "barrett"}, {600, 1200, 2400, 4800, 9600, 19200, 38400}},
          {{"dynamixel", "parallel_jaw"}, servos},
          {{"dynamixel", "dlr"}, servos},
          {{"robotiq_2f85", "robotiq_2f85"}, {9600, 19200, 38400, 57600, 115200}},
          {{"inspire_rh56", "inspire_rh56"}, {9600, 19200, 57600, 115200, 921600}}};
}

nlohmann::json measure_rates(bool json, double seconds, std::string_view driver) {
  constexpr double as_fast_as_it_can = 500;  // Hz
  nlohmann::json rows = nlohmann::json::array();
  if (!json)
    fmt::print(
        "| driver | hand | baud | bytes a round | floor, rounds/s | rounds/s | share of the floor "
        "|\n|---|---|---|---|---|---|---|\n");
  for (const auto& [wired, bauds] : all_speeds())
    for (const int baud : bauds) {
      if (!driver.empty() && wired.driver != driver) continue;
      const test::Cycle cycle = test::measure_cycle(wired, baud, as_fast_as_it_can, seconds);
      const double floor = cycle.bytes > 0 ? baud / 10.0 / cycle.bytes : 0;
      rows.push_back({{"driver", wired.driver},
                      {"hand", wired.hand},
                      {"baud", baud},
                      {"bytes", cycle.bytes},
                      {"floor_hz", floor},
                      {"rounds_hz", cycle.rounds},
                      {"trouble", cycle.trouble}});
      if (json) continue;
      if (cycle.trouble.empty())
        fmt::print("| {} | {} | {} | {:.0f} | {:.1f} | {:.1f} | {:.0f} % |\n", wired.driver,
                   wired.hand, baud, cycle.bytes, floor, cycle.rounds, 100 * cycle.rounds / floor);
      else
        fmt::print("| {} | {} | {} | | | 0 | «{}» |\n", wired.driver, wired.hand, baud,
                   cycle.trouble);
      std::fflush(stdout);
    }
  return rows;
}

std::string text_of(const std::optional<double>& s) {
  return s ? fmt::format("{:.2f}", *s) : "–";
}

nlohmann::json json_of(const std::optional<double>& s) {
  return s ? nlohmann::json(*s) : nlohmann::json();
}

nlohmann::json play_faults(bool json) {
  nlohmann::json rows = nlohmann::json::array();
  if (!json)
    fmt::print(
        "| driver | fault | named, s | words | held, s | ready again, s | left out |\n"
        "|---|---|---|---|---|---|---|\n");
  for (const auto& wired : test::wired_hands())
    for (const auto& fault : test::played_faults()) {
      if (!fault.befalls(wired)) continue;
      const test::FaultPlay played = test::play(wired, fault, 1);
      rows.push_back({{"driver", wired.driver},
                      {"fault", fault.name},
                      {"named_s", json_of(played.named)},
                      {"words", played.words},
                      {"held_s", json_of(played.held)},
                      {"ready_s", json_of(played.ready)},
                      {"homed", played.homed},
                      {"follows", played.follows},
                      {"astray", played.astray},
                      {"rejects", played.rejects},
                      {"reject", played.reject}});
      if (json) continue;
      const std::string ready = !played.named ? "–" : text_of(played.ready);
      fmt::print("| {} | {} | {} | {} | {} | {}{}{} | {}{} |\n", wired.driver, fault.name,
                 text_of(played.named), played.words, text_of(played.held), ready,
                 played.homed ? ", homed" : "", played.follows ? "" : ", does not follow",
                 played.rejects, played.reject.empty() ? "" : " as «" + played.reject + "»");
    }
  return rows;
}

}  // namespace
}  // namespace prehend

int main(int argc, char** argv) {
  using namespace prehend;
  bool json = false, rates = false, faults = false;
  double seconds = 3;
  std::string_view driver;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    json |= word == "--json";
    rates |= word == "--rates";
    faults |= word == "--faults";
    if (word == "--seconds" && i + 1 < argc) seconds = std::atof(argv[++i]);
    if (word == "--driver" && i + 1 < argc) driver = argv[++i];
  }
  const bool all = !rates && !faults;
  nlohmann::json made;
  if (rates || all) made["rates"] = measure_rates(json, seconds, driver);
  if (faults || all) made["faults"] = play_faults(json);
  if (json) std::cout << made.dump() << "\n";
}
