// prehend-study: repeats the experiments of [Thesis] and says which of its findings hold.
#include "services/mapping/tools/study/study_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>

#include "common/base/log.hpp"
#include "common/base/progress.hpp"
#include "common/base/workers.hpp"
#include "common/tool/program.hpp"
#include "services/mapping/tools/judging/summary_json.hpp"
#include "services/mapping/tools/study/report.hpp"

namespace prehend::mapping {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Finding& finding) {
  return {{"figure", finding.figure},
          {"claim", finding.claim},
          {"measured", finding.measured},
          {"reproduced", finding.verdict == Reproduction::reproduced},
          {"verdict", to_string(finding.verdict)},
          {"reason", finding.reason}};
}

constexpr const char* benchmark_name = "benchmark";

std::set<std::string> mode_words() {
  std::set<std::string> words;
  for (const auto& row : benchmark_modes)
    if (row.value != BenchmarkMode::external) words.emplace(row.name);
  return words;
}

struct Arguments {
  StudyOptions options;
  std::vector<std::string> only, modes;
  std::string out, recordings, shard, progress;
  std::vector<std::string> merge;
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

void add_shards(CLI::App& app, Arguments& arguments) {
  auto* shard = app.add_option("--shard", arguments.shard,
                               "I/N: only this part of the grasp benchmark, into a file in --out;\n"
                               "one that was broken off goes on where its file ends");
  auto* merge = app.add_option("--merge", arguments.merge,
                               "files of all shards: what one run would have given")
                    ->excludes(shard);
  app.add_option("--progress", arguments.progress,
                 "a folder of shards: how far each is. Exit code 0: all are done, 1: not yet")
      ->excludes(shard)
      ->excludes(merge);
}

struct StudyResults {
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

grasping::ForEach shared_by_threads(const Arguments& arguments) {
  return [&arguments](std::size_t count, const auto& work) {
    share_work(count, arguments.threads, work, [](std::size_t) {});
  };
}

Expected<std::vector<TrialResult>> grasp(const Parts& parts, const Arguments& arguments) {
  Progress progress("grasping");
  return run_benchmark(
      benchmark_of(parts, arguments.options), shared_by_threads(arguments),
      [&](double share) { progress.show(static_cast<std::size_t>(100 * share), 100); });
}

Expected<StudyResults> repeat(const Arguments& arguments) {
  const auto begin = std::chrono::steady_clock::now();
  std::vector<Experiment> chosen = experiments();
  std::erase_if(chosen, [&](const Experiment& one) { return !arguments.asks_for(one.figure); });
  auto parts = load_asked(arguments, chosen);
  if (!parts) return tl::unexpected(parts.error());
  StudyResults made;
  made.studied = study(*parts, chosen, arguments.options, [&](std::size_t count, const auto& work) {
    Progress progress("repeating the experiments");
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

int do_shard(const Arguments& arguments) {
  if (arguments.only != std::vector<std::string>{benchmark_name})
    return tool::complain({"is of the benchmark alone", "--shard", "give --only benchmark"},
                          exit_wrong_use);
  if (arguments.out.empty())
    return tool::complain({"needs a folder for its file", "--shard", "give --out"}, exit_wrong_use);
  const auto number = parse_shard(arguments.shard);
  if (!number) return tool::complain(number.error());
  const auto parts = load_parts(arguments.options.hands, true);
  if (!parts) return tool::complain(parts.error(), exit_broken);
  const auto file = shard_file(arguments.out, *number);
  Progress progress("grasping");
  const auto shard = run_shard(
      benchmark_of(*parts, arguments.options), *number, file, shared_by_threads(arguments),
      [&](double share) { progress.show(static_cast<std::size_t>(100 * share), 100); });
  if (!shard) return tool::complain(shard.error(), exit_broken);
  if (arguments.json)
    std::cout << Json{{"shard", to_string(*number)},
                      {"done", shard->done.size()},
                      {"takes", shard->pieces},
                      {"file", file.string()}}
                     .dump(2)
              << '\n';
  log::info("shard {}: {} takes, {}", to_string(*number), shard->done.size(), file.string());
  return exit_done;
}

int show_progress(const Arguments& arguments) {
  const auto shards = shard_progress(arguments.progress);
  if (!shards) return tool::complain(shards.error(), exit_broken);
  std::size_t complete = 0;
  Json document = Json::array();
  for (const ShardProgress& one : *shards) {
    complete += one.is_complete();
    document.push_back({{"shard", to_string(one.number)}, {"done", one.done}, {"takes", nullptr}});
    if (one.begun) document.back()["takes"] = one.pieces;
    if (!arguments.json)
      std::cout << fmt::format("{:>9}  {}\n", to_string(one.number),
                               one.begun ? fmt::format("{} of {} takes", one.done, one.pieces)
                                         : std::string("not begun"));
  }
  if (arguments.json)
    std::cout << Json{{"shards", document}, {"complete", complete == shards->size()}}.dump(2)
              << '\n';
  else
    std::cout << fmt::format("{} of {} shards are done\n", complete, shards->size());
  return complete == shards->size() ? exit_done : exit_no;
}

/// What the shards came to. The report says of the benchmark what the shards do.
Expected<StudyResults> merge(Arguments& arguments) {
  auto merged = merge_shards(
      std::vector<std::filesystem::path>(arguments.merge.begin(), arguments.merge.end()));
  if (!merged) return tl::unexpected(merged.error());
  for (const auto& [name, value] : merged->settings) {
    if (name == "seed") arguments.options.seed = std::strtoull(value.c_str(), nullptr, 10);
    if (name == "quick") arguments.options.quick = value == "yes";
  }
  StudyResults made{{}, std::move(merged->trials), {}, 0};
  made.summaries = summarise(made.trials);
  if (!arguments.out.empty())
    if (auto ok = write_report(arguments.out, {}, made.trials, arguments.options); !ok)
      return tl::unexpected(ok.error());
  return made;
}

Json to_json(const StudyResults& outcome, const StudyOptions& options) {
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

int study_command(const std::vector<std::string>& texts) {
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
  add_shards(app, arguments);
  if (const auto code = tool::parse(app, texts)) return *code;
  for (const auto& [mode, name, help] : benchmark_modes)
    if (std::find(arguments.modes.begin(), arguments.modes.end(), name) != arguments.modes.end())
      arguments.options.modes.push_back(mode);

  if (!arguments.progress.empty()) return show_progress(arguments);
  if (!arguments.shard.empty()) return do_shard(arguments);
  const auto outcome = arguments.merge.empty() ? repeat(arguments) : merge(arguments);
  if (!outcome) return tool::complain(outcome.error(), exit_broken);
  if (arguments.json) {
    std::cout << to_json(*outcome, arguments.options).dump(2) << '\n';
    return exit_done;
  }
  std::cout << to_markdown(outcome->studied, outcome->summaries);
  log::info("{:.0f} s{}", outcome->seconds,
            arguments.out.empty() ? "" : ", " + arguments.out + "/report.html");
  return exit_done;
}

}  // namespace prehend::mapping
