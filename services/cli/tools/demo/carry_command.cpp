#include "services/cli/tools/demo/carry_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "services/cli/tools/demo/carry_play.hpp"
#include "services/cli/tools/demo/screen.hpp"

namespace prehend::cli {
namespace {

std::string to_json(const Carried& carried, const CarryOptions& options) {
  return nlohmann::ordered_json{
      {"task", options.task == CarryTask::carry ? "carry" : "hand-over"},
      {"hands", {{"left", options.hands.left}, {"right", options.hands.right}}},
      {"seed", options.seed},
      {"lifted_m", carried.lifted},
      {"off_m", carried.off},
      {"tilt_rad", carried.tilt},
      {"both", carried.both},
      {"held", carried.held},
      {"handed_over", carried.handed_over},
      {"set_down", carried.set_down},
      {"done", carried.done(options.task)}}
      .dump();
}

std::string to_line(const Carried& carried, CarryTask task) {
  const bool carries = task == CarryTask::carry;
  const std::string_view did = carries ? "carried" : "handed over";
  return fmt::format(
      "{}{}: lifted by {:.0f} mm, {} {:.0f} mm from its place, tilted by {:.1f} degrees, in {} "
      "{:.0f} % of the way",
      carried.done(task) ? "" : "not ", did, 1000 * carried.lifted,
      carried.set_down ? "set down"
      : carried.fell   ? "lies"
                       : "is",
      1000 * carried.off, carried.tilt * 180 / std::numbers::pi, carries ? "both hands" : "a hand",
      100 * (carries ? carried.both : carried.held));
}

}  // namespace

int carry_command(const std::vector<std::string>& arguments) {
  CLI::App app{
      "Two robot hands in one world carry a crate that is too wide for one of them, or hand a "
      "tube\n"
      "from the left one to the right one, as a person with two gloves shows it: a device, a\n"
      "glove, a mapping and a gate for each. Exit code 0: lifted by 10 cm, and carried 30 cm\n"
      "aside, set down within 3 cm, level within 10 degrees, or handed over and held for a\n"
      "second; 1: not so, 2: wrong use, 3: the environment is broken.",
      "prehend demo --hands"};
  CarryOptions options;
  std::vector<std::string> hands;
  std::string task = "carry";
  bool json = false, quiet = false;
  options.lab.add_to(app);
  app.add_option("--hands", hands,
                 "left:HAND,right:HAND; a left one may be named as its mirror image")
      ->required()
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--task", task, "carry or hand-over")
      ->check(CLI::IsMember({"carry", "hand-over"}));
  app.add_option("--seed", options.seed, "draws the object, where it stands, person and noise");
  app.add_option("--glove", options.glove,
                 "DEVICE of both, see `prehend glove devices`: what has an emulator is emulated");
  app.add_option("--timeout", options.timeout, "s until it must stand again")
      ->check(CLI::Range(1.0, 3600.0));
  app.add_option("--record", options.record, "record all topics into this file");
  auto* watch = app.add_flag("--watch", options.watch,
                             "with a page that shows it (console.port), until Ctrl-C");
  app.add_flag("--attach", options.attach, "start nothing, judge the lab that runs")
      ->excludes(watch);
  app.add_flag("--keep", options.keep, "keep scene and logs");
  app.add_flag("--json", json, "one JSON document on standard output");
  app.add_flag("--quiet", quiet, "no progress");
  if (const auto code = service::parse(app, arguments)) return *code;
  options.task = task == "carry" ? CarryTask::carry : CarryTask::hand_over;
  const auto read = read_hands(hands);
  if (!read) return service::complain(read.error());
  options.hands = *read;

  Screen screen(quiet);
  const auto carried = carry(options, screen.progress());
  screen.clear();
  if (!carried) return service::complain(carried.error());
  std::cout << (json ? to_json(*carried, options) : to_line(*carried, options.task)) << std::endl;
  return carried->done(options.task) ? exit_done : exit_no;
}

}  // namespace prehend::cli
