#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/log_format.hpp"
#include "common/base/to_terminal.hpp"
#include "services/glove/core/filter_report.hpp"
#include "services/glove/files/hand_recording.hpp"
#include "services/glove/tools/commands.hpp"

namespace prehend::glove {
namespace {

struct FilterReportArguments {
  std::vector<std::filesystem::path> files;
  TrackerNoise noise;
  double rate = 0;
  int rounds = 5;
  bool json = false;
};

nlohmann::ordered_json to_json(const std::string& name, const FilterStats& f) {
  return {{"recording", name},
          {"frames", f.frames},
          {"slow", f.slow},
          {"noise_in_m", f.noise_in},
          {"noise_out_m", f.noise_out},
          {"fast", f.fast},
          {"lag_ms", f.fast > 0 ? nlohmann::ordered_json(1000 * f.lag) : nullptr},
          {"extremes", f.extremes},
          {"moved_m", f.moved},
          {"moved_over_5_mm", f.far},
          {"withheld", f.withheld}};
}

void print(const std::string& name, const FilterStats& f) {
  const std::string lag = f.fast > 0 ? fmt::format("{:.1f} ms", 1000 * f.lag) : "–";
  const std::string ratio = f.noise_in > 0 ? fmt::format("{:.2f}", f.noise_out / f.noise_in) : "–";
  to_terminal("| {} | {} | {:.2f} mm | {:.2f} mm | {} | {} | {} | {:.1f} mm | {} | {:.2f} % |\n",
              name, f.frames, 1000 * f.noise_in, 1000 * f.noise_out, ratio, lag, f.extremes,
              1000 * f.moved, f.far, 100 * f.withheld);
}

/// 0 when something was measured, 1 when no file is a recording.
int report(const FilterReportArguments& arguments) {
  if (!arguments.json)
    to_terminal(
        "| recording | frames | noise in | error out | ratio | lag | extreme points | furthest "
        "moved | over 5 mm | withheld |\n|---|---|---|---|---|---|---|---|---|---|\n");
  FilterMeasurement all(arguments.noise);
  for (const auto& file : arguments.files) {
    const auto recording = Recording::load(file, {});
    if (!recording) {
      // An index lies beside recordings: no reason to measure none of them.
      log::warning(recording.error());
      continue;
    }
    if (const std::string told = recording->left_out(); !told.empty())
      log::warning("{}: left out: {}", file.string(), told);
    for (const std::string& remark : recording->remarks())
      log::warning("{}: {}", file.string(), remark);
    const std::vector<Frame> frames = frames_of(*recording, arguments.rate);
    FilterMeasurement one(arguments.noise);
    for (int round = 0; round < arguments.rounds; ++round) one.add(frames);
    all.add(one);
    if (arguments.json)
      std::cout << to_json(file.stem(), one.stats()).dump() << '\n';
    else
      print(file.stem(), one.stats());
  }
  if (arguments.json)
    std::cout << to_json("all", all.stats()).dump() << '\n';
  else
    print("all", all.stats());
  return all.stats().frames > 0 ? 0 : 1;
}

}  // namespace

void add_filter_report(tool::Program& program) {
  auto* command = program.app().add_subcommand(
      "filter-report", "what the filter makes of recordings that a tracker's noise is added to");
  const auto a = std::make_shared<FilterReportArguments>();
  command->add_option("FILE", a->files, "hand recordings, as glove.file takes them")->required();
  command->add_option("--rate", a->rate, "Hz, of a slower tracker; 0: every frame of the recording")
      ->check(CLI::Range(0.0, 1000.0));
  command->add_option("--sigma", a->noise.sigma, "m, noise of a coordinate")->capture_default_str();
  command->add_option("--extreme-rate", a->noise.extreme_rate, "share of extreme points")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--seed", a->noise.seed, "of the noise")->capture_default_str();
  command->add_option("--rounds", a->rounds, "times that each recording is measured")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_flag("--json", a->json, "one JSON document a recording");
  program.on(*command, [a] { return report(*a); });
}

}  // namespace prehend::glove
