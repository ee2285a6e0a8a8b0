#include "services/cli/tools/demo/demo_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <iostream>
#include <string_view>

#include "common/base/printable.hpp"
#include "services/cli/tools/demo/chosen_hand.hpp"
#include "services/cli/tools/demo/demonstration.hpp"
#include "services/cli/tools/demo/screen.hpp"
#include "services/cli/tools/demo/series.hpp"

namespace prehend::cli {
namespace {

/// "A..B" or "A" as seeds.
bool read_range(const std::string& text, SeriesOptions& series) {
  const auto read = [](std::string_view word, std::uint64_t& seed) {
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), seed);
    return error == std::errc() && end == word.data() + word.size();
  };
  const std::size_t dots = text.find("..");
  const std::string_view first = std::string_view(text).substr(0, dots);
  if (!read(first, series.first)) return false;
  if (!read(dots == std::string::npos ? first : std::string_view(text).substr(dots + 2),
            series.last))
    return false;
  return series.first <= series.last && series.last - series.first < 10000;
}

/// What measures, sees and moves.
void add_devices(CLI::App& app, DemoOptions& demo) {
  app.add_option(
      "--glove", demo.glove,
      "DEVICE[:PORT or FILE], see `prehend glove devices`: what has an emulator is\n"
      "emulated unless a port is given, HOST:PORT for datagrams; webcam: your own hand, by\n"
      "the page of --watch");
  app.add_option("--camera", demo.camera, "SOURCE[:PATH], see `prehend camera sources`");
  auto* robot =
      app.add_option("--robot", demo.robot,
                     "emulated:DEVICE, see `prehend robot emulate`: its driver moves the hand");
  app.add_option("--arm", demo.arm, "the arm that carries the hand, a name or folder: puma560")
      ->excludes(robot);
}

/// For the help: these are read before, by who chooses the play.
void add_choices(CLI::App& app) {
  app.add_option("--task",
                 "a task (pick-and-place), or a file of one: it is shown, and done again "
                 "elsewhere;\nprehend demo --task pick-and-place --help tells more");
  app.add_option("--hands",
                 "left:HAND,right:HAND: two hands carry a crate together, or hand a tube over;\n"
                 "prehend demo --hands left:HAND,right:HAND --help tells more");
  app.add_flag_callback(
      "--targets", [] {}, "only say what `cmake --build` must make for this");
}

void choose(DemoOptions& demo, const std::string& mode) {
  demo.direct = mode == "direct";
  if (demo.hand.empty()) demo.hand = hand_of_robot(demo.robot);
  demo.planned = is_planned_for(demo.hand, mode);
}

}  // namespace

int demo_command(const std::vector<std::string>& arguments) {
  CLI::App app{
      "Starts glove, recognition, mapping and simulation as processes on this machine, plays a\n"
      "demonstration through them and says what was grasped and how well. Exit code 0: held,\n"
      "1: not held, 2: wrong use, 3: the environment is broken.",
      "prehend demo"};
  DemoOptions demo;
  SeriesOptions series;
  bool json = false, quiet = false;
  std::string mode, seeds;
  demo.lab.add_to(app);
  auto* seed = app.add_option("--seed", demo.seed, "draws object, poses, light, person and noise");
  app.add_option("--object", demo.object, "the object that is reached for");
  app.add_option("--hand", demo.hand, "the robot hand");
  app.add_option("--without", demo.without, "a service that is left out; may be repeated")
      ->check(CLI::IsMember({"glove", "recognition", "mapping", "simulation"}))
      ->type_size(1)
      ->allow_extra_args(false);
  add_devices(app, demo);
  app.add_option("--mode", mode,
                 "direct: the mapping does not use what is recognised; intelligent: it does;\n"
                 "planned: grasps are planned for what is seen before the hand reaches, and it\n"
                 "follows the nearest. Without it intelligent; for a hand of your own planned")
      ->check(CLI::IsMember({"direct", "intelligent", "planned"}));
  app.add_option("--timeout", demo.timeout, "s until it ends without a grasp")
      ->check(CLI::Range(1.0, 3600.0));
  app.add_option("--record", demo.record, "record all topics into this file");
  add_choices(app);
  auto* watch =
      app.add_flag("--watch", demo.watch, "with a page that shows it (console.port), until Ctrl-C");
  app.add_flag("--attach", demo.attach, "start nothing, judge the lab that runs")->excludes(watch);
  app.add_flag("--keep", demo.keep, "keep scene and logs");
  app.add_flag("--json", json, "one JSON document on standard output");
  app.add_flag("--quiet", quiet, "no progress");
  app.add_option("--seeds", seeds, "A..B: a table over several seeds")->excludes(seed, watch);
  app.add_flag("--compare-direct", series.compare_direct,
               "with --seeds: each once more with direct mapping");
  if (const auto code = service::parse(app, arguments)) return *code;
  choose(demo, mode);

  Screen screen(quiet);
  const stage::Progress progress = screen.progress();
  if (!seeds.empty()) {
    series.json = json;
    if (!read_range(seeds, series))
      return service::complain({"must be A..B", "--seeds " + seeds, ""}, exit_wrong_use);
    return run_series(demo, series, progress);
  }
  const auto show = [&](const Outcome& outcome) {
    screen.clear();
    std::cout << (json ? to_json(outcome) + "\n" : printable(to_table(outcome), "\n"))
              << std::flush;
  };
  if (demo.watch) demo.on_outcome = show;
  const auto outcome = demonstrate(demo, progress);
  screen.clear();
  if (!outcome) return service::complain(outcome.error());
  if (!demo.watch) show(*outcome);
  return outcome->grasp.held ? exit_done : exit_no;
}

}  // namespace prehend::cli
