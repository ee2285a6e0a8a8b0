// prehend-study: repeats the thesis's experiments and says which of its findings hold.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <prehend/base/log.hpp>
#include <prehend/base/progress.hpp>
#include <prehend/base/workers.hpp>
#include <set>

#include "report.hpp"

namespace {

using namespace prehend;
using namespace prehend::mapping;
using Json = nlohmann::ordered_json;

Json to_json(const Finding& finding) {
  return {{"figure", finding.figure},
          {"claim", finding.claim},
          {"measured", finding.measured},
          {"reproduced", finding.verdict == Verdict::reproduced},
          {"verdict", to_string(finding.verdict)},
          {"reason", finding.reason}};
}

Json to_json(const Interval& interval) {
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

constexpr std::array every_mode{BenchmarkMode::direct, BenchmarkMode::cartesian,
                                BenchmarkMode::combined, BenchmarkMode::retargeting,
                                BenchmarkMode::intelligent};

}  // namespace

int main(int argc, char** argv) {
  log::set_name("study");
  StudyOptions options;
  std::vector<std::string> only, modes;
  std::string out, recordings;
  if (const char* data = std::getenv("PREHEND_SHARED_DATA"))
    recordings = std::string(data) + "/leap_hand_recordings";
  unsigned threads = 0;
  bool json = false;
  std::vector<Experiment> chosen = experiments();
  std::set<std::string> figures{benchmark_name};
  for (const Experiment& experiment : chosen) figures.insert(experiment.figure);

  CLI::App app{
      "Repeats the thesis's experiments over many people and first weights, and says of each of "
      "its\n"
      "findings whether it is reproduced. Exit code 0: done, 2: wrong use, 3: something is "
      "missing\n"
      "or cannot be written."};
  app.add_flag("--quick", options.quick, "few repetitions; else about an hour");
  app.add_option("--only", only, "figures, e.g. 5.14,6.7, and benchmark; else all")
      ->delimiter(',')
      ->check(CLI::IsMember(figures));
  app.add_option("--seed", options.seed, "of people and first weights")->capture_default_str();
  app.add_option("--out", out, "folder for report.html and a CSV and PNG a figure");
  app.add_option("--recordings", recordings,
                 "Leap recordings of real hands, a folder; default: leap_hand_recordings in\n"
                 "PREHEND_SHARED_DATA. Without any, figure «real» is left out");
  app.add_option("--trials", options.trials,
                 "of the grasp benchmark for each hand and mode; default: 24 quick, 270 full")
      ->check(CLI::Range(1, 100'000));
  app.add_option("--modes", modes, "that the grasp benchmark judges, with and without placement")
      ->delimiter(',')
      ->check(CLI::IsMember({"direct", "cartesian", "combined", "retargeting", "intelligent"}));
  app.add_option("--hands", options.hands, "that the grasp benchmark is made with; default: all")
      ->delimiter(',')
      ->check(CLI::IsMember(std::set<std::string>(benchmark_hands.begin(), benchmark_hands.end())));
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
  app.add_option("--threads", threads, "0: one a core; the answer is the same")
      ->capture_default_str()
      ->check(CLI::Range(0, 1024));
  app.add_flag("--json", json, "print the findings as one JSON document");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  for (const BenchmarkMode mode : every_mode)
    if (std::find(modes.begin(), modes.end(), to_string(mode)) != modes.end())
      options.modes.push_back(mode);
  const auto asked = [&](const std::string& name) {
    return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
  };
  std::erase_if(chosen, [&](const Experiment& experiment) { return !asked(experiment.figure); });
  const auto refuse = [](const Error& error) {
    log::error("{}", error.message());
    return 3;
  };

  const auto begin = std::chrono::steady_clock::now();
  const bool grasping = asked(benchmark_name);
  auto takes = load_real_takes(recordings);
  if (!takes && std::erase_if(chosen, [](const Experiment& one) { return one.recordings; }) > 0)
    log::warning("figure «real» is left out: {}",
                 recordings.empty() ? "give --recordings" : takes.error().message());
  const bool trained =
      std::any_of(chosen.begin(), chosen.end(), [](const auto& one) { return one.trained; });
  auto hands = hands_of(chosen);
  if (grasping) hands.insert(hands.end(), options.hands.begin(), options.hands.end());
  auto parts = load_parts(hands, grasping || trained);
  if (!parts) return refuse(parts.error());
  if (takes) parts->real_takes = std::move(*takes);
  const auto studied = study(*parts, chosen, options, [&](std::size_t count, const auto& work) {
    prehend::Progress progress("repeating the experiments");
    share_work(count, threads, work, [&](std::size_t done) { progress.show(done, count); });
  });
  std::vector<TrialResult> trials;
  if (grasping) {
    prehend::Progress progress("grasping");
    std::mutex mutex;
    auto made = benchmark(
        *parts, options,
        [&](std::size_t count, const auto& work) {
          share_work(count, threads, work, [](std::size_t) {});
        },
        [&](double share) {
          const std::lock_guard lock(mutex);
          progress.show(static_cast<std::size_t>(100 * share), 100);
        });
    if (!made) return refuse(made.error());
    trials = std::move(*made);
  }
  const auto summaries = summarise(trials);
  if (!out.empty())
    if (auto ok = write_report(out, studied, trials, options); !ok) return refuse(ok.error());
  const double took =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (json) {
    Json document{{"seed", options.seed},
                  {"quick", options.quick},
                  {"seconds", took},
                  {"findings", Json::array()},
                  {"grasp_benchmark", Json::array()}};
    for (const Studied& one : studied)
      for (const Finding& finding : one.outcome.findings)
        document["findings"].push_back(to_json(finding));
    for (const ModeSummary& one : summaries) document["grasp_benchmark"].push_back(to_json(one));
    std::cout << document.dump(2) << '\n';
    return 0;
  }
  std::cout << to_markdown(studied, summaries);
  log::info("{:.0f} s{}", took, out.empty() ? "" : ", " + out + "/report.html");
  return 0;
}
