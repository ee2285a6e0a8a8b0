// prehend-study: repeats the experiments of [Thesis] and says which of its findings hold.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>

#include "common/base/log.hpp"
#include "common/base/progress.hpp"
#include "common/base/workers.hpp"
#include "common/tool/program.hpp"
#include "services/mapping/tools/study/report.hpp"

namespace {

using namespace prehend;
using namespace prehend::mapping;
using Json = nlohmann::ordered_json;

Json to_json(const Finding& finding) {
  return {{"figure", finding.figure},
          {"claim", finding.claim},
          {"measured", finding.measured},
          {"reproduced", finding.verdict == Reproduction::reproduced},
          {"verdict", to_string(finding.verdict)},
          {"reason", finding.reason}};
}

Json to_json(const statistics::Interval& interval) {
  return {interval.low, interval.high};
}

Json to_json(const ModeSummary& one) {
  Json made{{"hand", one.hand},
            {"mode", to_string(one.mode.mode)},
            {"placement", one.mode.placement},
            {"trials", one.held.count},
            {"held_rate", one.held.mean},
            {"held_ci95", to_json(one.held)},
            {"demonstrated_trials", one.held_of_demonstrated.count},
            {"demonstrated_held_rate", nullptr},
            {"demonstrated_held_ci95", to_json(one.held_of_demonstrated)},
            {"above_direct", nullptr},
            {"above_direct_ci95", nullptr},
            {"joint_error", one.joint_error.mean},
            {"fingertip_error_m", one.fingertip_error.mean},
            {"epsilon", one.epsilon.mean},
            {"penetration_m", one.penetration.mean}};
  if (one.held_of_demonstrated.count > 0)
    made["demonstrated_held_rate"] = one.held_of_demonstrated.mean;
  if (one.above_direct.count > 1) {
    made["above_direct"] = one.above_direct.mean;
    made["above_direct_ci95"] = to_json(one.above_direct);
  }
  return made;
}

constexpr const char* benchmark_name = "benchmark";

std::set<std::string> mode_words() {
  std::set<std::string> words;
  for (const auto& row : benchmark_modes) words.emplace(row.name);
  return words;
}

struct Arguments {
  StudyOptions options;
  std::vector<std::string> only, modes;
  std::string out, recordings;
  unsigned threads = 0;
  bool json = false;

  bool asks_for(const std::string& figure) const {
    return only.empty() || std::find(only.begin(), only.end(), figure) != only.end();
  }
};

void add_study(CLI::App& app, Arguments& arguments) {
  std::set<std::string> figures{benchmark_name};
  for (const Experiment& experiment : experiments()) figures.insert(experiment.figure);
  if (const char* data = std::getenv("PREHEND_SHARED_DATA"))
    arguments.recordings = std::string(data) + "/leap_hand_recordings";
  app.add_flag("--quick", arguments.options.quick, "few repetitions; else about an hour");
  app.add_option("--only", arguments.only, "figures, e.g. 5.14,6.7, and benchmark; else all")
      ->delimiter(',')
      ->check(CLI::IsMember(figures));
  app.add_option("--seed", arguments.options.seed, "of people and first weights")
      ->capture_default_str();
  app.add_option("--out", arguments.out, "folder for report.html and a CSV and PNG a figure");
  app.add_option("--recordings", arguments.recordings,
                 "Leap recordings of real hands, a folder; default: leap_hand_recordings in\n"
                 "PREHEND_SHARED_DATA. Without any, figure «real» is left out");
  app.add_option("--threads", arguments.threads, "0: one a core; the answer is the same")
      ->capture_default_str()
      ->check(CLI::Range(0, 1024));
  app.add_flag("--json", arguments.json, "print the findings as one JSON document");
}

void add_benchmark(CLI::App& app, Arguments& arguments) {
  StudyOptions& options = arguments.options;
  app.add_option("--trials", options.trials,
                 "of the grasp benchmark for each hand and mode; default: 24 quick, 270 full")
      ->check(CLI::Range(1, 100'000));
  app.add_option("--modes", arguments.modes,
                 "that the grasp benchmark judges, with and without placement")
      ->delimiter(',')
      ->check(CLI::IsMember(mode_words()));
  app.add_option("--hands", options.hands, "that the grasp benchmark is made with; default: all")
      ->delimiter(',')
      ->check(CLI::IsMember(std::set<std::string>(thesis_hands.begin(), thesis_hands.end())));
  app.add_option("--size-error", options.take.size_error,
                 "grasp benchmark: objects are seen larger or smaller by this share")
      ->check(CLI::Range(0.0, 0.5));
  app.add_option("--position-error", options.take.position_error,
                 "grasp benchmark: sigma of where objects are seen, m a coordinate")
      ->check(CLI::Range(0.0, 0.1));
  app.add_option("--claimed-error", options.take.claimed_error,
                 "grasp benchmark: the same as the camera tells it, if that is more, m")
      ->check(CLI::Range(0.0, 1.0));
  app.add_flag(
      "--late", options.take.late,
      "grasp benchmark: hands at rest get ready only when they close, not while they reach");
}

struct Outcome {
  std::vector<Studied> studied;
  std::vector<TrialResult> trials;
  std::vector<ModeSummary> summaries;
  double seconds = 0;
};

/// Those asked for; without recordings, only those that need none.
Expected<Parts> load_asked(const Arguments& arguments, std::vector<Experiment>& chosen) {
  auto takes = load_real_takes(arguments.recordings);
  if (!takes && std::erase_if(chosen, [](const Experiment& one) { return one.recordings; }) > 0)
    log::warning("figure «real» is left out: {}",
                 arguments.recordings.empty() ? "give --recordings" : takes.error().message());
  const bool grasping = arguments.asks_for(benchmark_name);
  const bool trained =
      std::any_of(chosen.begin(), chosen.end(), [](const auto& one) { return one.trained; });
  auto hands = hands_of(chosen);
  if (grasping)
    hands.insert(hands.end(), arguments.options.hands.begin(), arguments.options.hands.end());
  auto parts = load_parts(hands, grasping || trained);
  if (parts && takes) parts->real_takes = std::move(*takes);
  return parts;
}

Expected<std::vector<TrialResult>> grasp(const Parts& parts, const Arguments& arguments) {
  prehend::Progress progress("grasping");
  std::mutex mutex;
  return benchmark(
      parts, arguments.options,
      [&](std::size_t count, const auto& work) {
        share_work(count, arguments.threads, work, [](std::size_t) {});
      },
      [&](double share) {
        const std::lock_guard lock(mutex);
        progress.show(static_cast<std::size_t>(100 * share), 100);
      });
}

Expected<Outcome> repeat(const Arguments& arguments) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<Experiment> chosen = experiments();
  std::erase_if(chosen, [&](const Experiment& one) { return !arguments.asks_for(one.figure); });
  auto parts = load_asked(arguments, chosen);
  if (!parts) return tl::unexpected(parts.error());
  Outcome made;
  made.studied = study(*parts, chosen, arguments.options, [&](std::size_t count, const auto& work) {
    prehend::Progress progress("repeating the experiments");
    share_work(count, arguments.threads, work,
               [&](std::size_t done) { progress.show(done, count); });
  });
  if (arguments.asks_for(benchmark_name)) {
    auto trials = grasp(*parts, arguments);
    if (!trials) return tl::unexpected(trials.error());
    made.trials = std::move(*trials);
  }
  made.summaries = summarise(made.trials);
  if (!arguments.out.empty())
    if (auto ok = write_report(arguments.out, made.studied, made.trials, arguments.options); !ok)
      return tl::unexpected(ok.error());
  made.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return made;
}

Json to_json(const Outcome& outcome, const StudyOptions& options) {
  Json document{{"seed", options.seed},
                {"quick", options.quick},
                {"seconds", outcome.seconds},
                {"findings", Json::array()},
                {"grasp_benchmark", Json::array()}};
  for (const Studied& one : outcome.studied)
    for (const Finding& finding : one.outcome.findings)
      document["findings"].push_back(to_json(finding));
  for (const ModeSummary& one : outcome.summaries)
    document["grasp_benchmark"].push_back(to_json(one));
  return document;
}

}  // namespace

int main(int argc, char** argv) {
  log::set_name("study");
  Arguments arguments;
  CLI::App app{
      "Repeats the thesis's experiments over many people and first weights, and says of each of "
      "its\n"
      "findings whether it is reproduced. Exit code 0: done, 2: wrong use, 3: something is "
      "missing\n"
      "or cannot be written."};
  add_study(app, arguments);
  add_benchmark(app, arguments);
  if (const auto code = tool::parse(app, argc, argv)) return *code;
  for (const auto& [mode, name, help] : benchmark_modes)
    if (std::find(arguments.modes.begin(), arguments.modes.end(), name) != arguments.modes.end())
      arguments.options.modes.push_back(mode);

  const auto outcome = repeat(arguments);
  if (!outcome) return tool::complain(outcome.error(), exit_broken);
  if (arguments.json) {
    std::cout << to_json(*outcome, arguments.options).dump(2) << '\n';
    return 0;
  }
  std::cout << to_markdown(outcome->studied, outcome->summaries);
  log::info("{:.0f} s{}", outcome->seconds,
            arguments.out.empty() ? "" : ", " + arguments.out + "/report.html");
  return 0;
}
