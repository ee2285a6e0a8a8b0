// prehend-benchmark: judges mappings, ours and others', by the same takes.
#include "services/mapping/tools/benchmark/benchmark_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include "common/base/file_text.hpp"
#include "common/base/log.hpp"
#include "common/base/paths.hpp"
#include "common/base/progress.hpp"
#include "common/base/workers.hpp"
#include "common/grasping/catalogue_bodies.hpp"
#include "common/service/arguments.hpp"
#include "common/stage/temporary_folder.hpp"
#include "services/mapping/files/mapping_model_file.hpp"
#include "services/mapping/tools/benchmark/external_mapping.hpp"
#include "services/mapping/tools/benchmark/own_by_messages.hpp"
#include "services/mapping/tools/benchmark/people.hpp"
#include "services/mapping/tools/benchmark/take_file.hpp"
#include "services/mapping/tools/judging/drawn_objects.hpp"
#include "services/mapping/tools/judging/planned_grasps.hpp"
#include "services/mapping/tools/judging/real_reach.hpp"
#include "services/mapping/tools/judging/summary_json.hpp"
#include "services/mapping/tools/training/derived_scheme.hpp"
#include "services/mapping/tools/training/first_use.hpp"

namespace prehend::mapping {
namespace {

constexpr std::string_view placed = "+placement";
constexpr std::chrono::milliseconds between_takes{1500};  // a live mapping forgets the last one

struct Arguments {
  service::LabArguments lab;
  std::vector<std::string> mappings{"external"};
  std::string hand, objects, takes, people, write_to, out, command, service = "mapping";
  GraspBenchmarkOptions asked;
  int trials = 24, each = 3;
  std::uint64_t seed = 1;
  unsigned threads = 0;
  bool lockstep = false, json = false;

  void add_to(CLI::App& app) {
    lab.add_to(app);
    app.add_option("--mapping", mappings,
                   "who is judged: external, and for comparison direct, cartesian, combined,\n"
                   "retargeting, intelligent or planned; MODE+placement: also corrects where the\n"
                   "hand is")
        ->delimiter(',')
        ->capture_default_str();
    app.add_option("--hand", hand, "kind of robot hand; default: the lab's");
    app.add_option("--objects", objects,
                   "a catalogue of other objects than those that the hand has learnt, or drawn:N:\n"
                   "N of all shapes, drawn from the seed");
    auto* folder = app.add_option("--takes", takes, "a folder of takes that --export wrote");
    app.add_option("--trials", trials, "takes that are made, where no folder is given")
        ->check(CLI::Range(1, 100'000))
        ->excludes(folder)
        ->capture_default_str();
    app.add_option("--seed", seed, "of the people in them")->excludes(folder);
    app.add_option("--size-error", asked.take.size_error,
                   "objects are seen so much larger, or smaller")
        ->check(CLI::Range(0.0, 0.5))
        ->excludes(folder);
    app.add_option("--position-error", asked.take.position_error,
                   "sigma of where objects are seen, m a coordinate")
        ->check(CLI::Range(0.0, 0.1))
        ->excludes(folder);
    app.add_option(
           "--people", people,
           "a folder of recordings of real hands (Leap or 21 landmarks: csv; hand/posture:\n"
           "mcap): their closings are takes, too, with objects put between their fingertips")
        ->excludes(folder);
    app.add_option("--each", each, "closings of real hands that are taken for each grasp")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    app.add_option("--export", write_to, "only write the takes, as recordings in this folder");
    app.add_option("--run", command,
                   "starts the external mapping, for each take anew, in a rig of its own\n"
                   "(PREHEND_LAB_RIG); without it one must be there in the lab's rig");
    app.add_flag("--lockstep", lockstep, "the external mapping follows lab/clock");
    app.add_option("--service", service, "as which it answers lab/progress")->capture_default_str();
    app.add_option("--threads", threads, "for our own mappings; 0: one a core")
        ->check(CLI::Range(0, 1024));
    app.add_option("--out", out, "folder for benchmark.csv");
    app.add_flag("--json", json, "print the table as one JSON document");
  }
};

/// All that a hand is judged with.
struct Judged {
  model::HandModel hand;
  MappingModel model;
  std::vector<RobotGrasp> grasps;
  grasping::CatalogueBodies objects;
  std::vector<BenchmarkTake> takes;

  BenchmarkedHand parts() const { return {hand, model, grasps, objects}; }
};

Expected<std::vector<BenchmarkedMode>> modes_of(const Arguments& arguments) {
  std::vector<BenchmarkedMode> modes;
  for (std::string name : arguments.mappings) {
    const bool placement = name.ends_with(placed);
    if (placement) name.resize(name.size() - placed.size());
    const auto mode = benchmark_modes.value(name);
    if (!mode || (placement && *mode == BenchmarkMode::external))
      return wrong_use("there is no mapping «" + name + "»", "--mapping", benchmark_modes.list());
    modes.push_back({*mode, placement});
  }
  return modes;
}

std::vector<BenchmarkTake> make_takes(const std::vector<RobotGrasp>& grasps,
                                      const Arguments& arguments) {
  GraspBenchmarkOptions asked = arguments.asked;
  asked.seed += arguments.seed;
  std::vector<BenchmarkTake> takes;
  for (const int number : first_takes(arguments.trials))
    if (auto take = make_take(grasps, asked, number)) takes.push_back(std::move(*take));
  return takes;
}

/// Says how far objects are off, for where they were in these hands is a guess.
Expected<void> add_people(std::vector<BenchmarkTake>& takes, const std::vector<RobotGrasp>& grasps,
                          const Arguments& arguments) {
  if (arguments.people.empty()) return {};
  const auto people = load_people(arguments.people);
  if (!people) return tl::unexpected(people.error());
  auto real = real_takes(*people, grasps, arguments.each, arguments.trials, arguments.asked.take);
  log::info("{} takes of {} recordings of real hands", real.size(), people->size());
  std::ranges::move(real, std::back_inserter(takes));
  return {};
}

/// What the hand can grasp of these objects: nobody has trained with it.
Expected<std::vector<RobotGrasp>> grasps_of(const model::HandModel& hand, const ModelPlaces& places,
                                            const grasping::CatalogueBodies& objects,
                                            unsigned threads) {
  const auto scheme = load_or_derive(places.scheme, hand);
  if (!scheme) return tl::unexpected(scheme.error());
  Progress progress("closing the hand");
  return close_on_catalogue(
      hand, *scheme, objects,
      [&](std::size_t count, const auto& work) {
        share_work(count, threads, work, [&](std::size_t done) { progress.show(done, count); });
      },
      [](const Error&) {}, Trials::quick());
}

Expected<model::Catalogue> objects_of(const Arguments& arguments) {
  constexpr std::string_view drawn = "drawn:";
  if (arguments.objects.starts_with(drawn)) {
    int count = 0;
    const std::string_view text = std::string_view(arguments.objects).substr(drawn.size());
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc{} || end != text.data() + text.size() || count < 1 || count > 10'000)
      return wrong_use("needs a number of objects, 1 to 10000", arguments.objects,
                       "for example drawn:200");
    return drawn_objects(count, arguments.seed);
  }
  if (arguments.objects.empty())
    return model::Catalogue::load(share_directory() / "models" / "objects" / "catalogue.toml");
  if (!std::filesystem::exists(arguments.objects))
    return wrong_use("is no file", arguments.objects, "a catalogue, or drawn:200");
  return model::Catalogue::load(arguments.objects);
}

Expected<Judged> load(const Arguments& arguments, const std::string& name) {
  auto hand = model::HandModel::load(model::hand_directory(name));
  if (!hand) return tl::unexpected(hand.error());
  auto catalogue = objects_of(arguments);
  if (!catalogue) return tl::unexpected(catalogue.error());
  auto objects = grasping::CatalogueBodies::create(*catalogue);
  if (!objects) return tl::unexpected(objects.error());
  const auto places = ready_places(name, *hand, Needs::model_and_grasps);
  if (!places) return tl::unexpected(places.error());
  auto model = load_mapping_model(places->model, *hand);
  if (!model) return tl::unexpected(model.error());
  auto grasps = arguments.objects.empty() ? load_robot_grasps(places->grasps, *hand)
                                          : grasps_of(*hand, *places, *objects, arguments.threads);
  if (!grasps) return tl::unexpected(grasps.error());
  if (grasps->empty())
    return fail("there is no grasp to repeat", hand->name(),
                "prehend train --hand HAND finds the grasps that are repeated");
  std::vector<BenchmarkTake> takes;
  if (arguments.takes.empty()) {
    takes = make_takes(*grasps, arguments);
    if (auto added = add_people(takes, *grasps, arguments); !added)
      return tl::unexpected(added.error());
    // Whoever reads the written ones gets the same; rounding twice would not be that.
    if (arguments.write_to.empty())
      for (BenchmarkTake& take : takes) take = as_read(std::move(take));
  } else {
    auto loaded = load_takes(arguments.takes, *hand);
    if (!loaded) return tl::unexpected(loaded.error());
    takes = std::move(*loaded);
  }
  return Judged{std::move(*hand), std::move(*model), std::move(*grasps), std::move(*objects),
                std::move(takes)};
}

Expected<std::vector<TrialResult>> judge_own(const Judged& judged, const BenchmarkedMode& mode,
                                             unsigned threads) {
  if (auto allowed = check_mode(judged.parts(), mode); !allowed)
    return tl::unexpected(allowed.error());
  std::vector<TrialResult> results(judged.takes.size());
  std::vector<Error> errors(results.size());
  PlannedGrasps planned(judged.hand, judged.objects);
  Progress progress(std::string(to_string(mode.mode)));
  share_work(
      results.size(), threads,
      [&](std::size_t i) {
        auto mapping = planned.mapping_for(judged.parts(), mode, judged.takes[i]);
        if (!mapping) {
          errors[i] = mapping.error();
          return;
        }
        OwnByMessages own(judged.hand, std::move(*mapping));
        auto result = judge_take(judged.parts(), judged.takes[i], mode, own);
        if (result)
          results[i] = std::move(*result);
        else
          errors[i] = result.error();
      },
      [&](std::size_t done) { progress.show(done, results.size()); });
  for (const Error& error : errors)
    if (!error.what.empty()) return tl::unexpected(error);
  return results;
}

Expected<std::vector<TrialResult>> judge_external(const Judged& judged, const Arguments& arguments,
                                                  const service::Config& lab) {
  const auto folder = stage::TemporaryFolder::create(false);
  if (!folder) return tl::unexpected(folder.error());
  ExternalOptions options{&lab,
                          judged.hand.name(),
                          {},
                          arguments.command,
                          folder->path() / "log",
                          arguments.lockstep,
                          arguments.service};
  std::vector<TrialResult> results;
  Progress progress("external");
  Duration lag{};
  for (const BenchmarkTake& take : judged.takes) {
    options.user = take.recorded.user;
    const auto external = ExternalMapping::meet(options);
    if (!external) return tl::unexpected(external.error());
    auto result = judge_take(judged.parts(), take, {BenchmarkMode::external}, **external);
    if (!result) return tl::unexpected(result.error());
    results.push_back(std::move(*result));
    lag = std::max(lag, (*external)->lag());
    progress.show(results.size(), judged.takes.size());
    if (arguments.command.empty()) std::this_thread::sleep_for(between_takes);
  }
  if (lag > std::chrono::milliseconds(50))
    log::warning("this machine is too slow: the world was {:.0f} ms late", 1000 * to_seconds(lag));
  return results;
}

Expected<void> write_takes(const Judged& judged, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(error.message(), folder.string());
  for (const BenchmarkTake& take : judged.takes)
    if (auto done =
            save_take(folder / fmt::format("take-{:04}.mcap", take.number), judged.hand, take);
        !done)
      return done;
  log::info("{} takes in {}", judged.takes.size(), folder.string());
  return {};
}

Expected<int> judge_all(const Arguments& arguments) {
  const auto modes = modes_of(arguments);
  if (!modes) return tl::unexpected(modes.error());
  const auto lab = arguments.lab.load();
  if (!lab) return tl::unexpected(lab.error());
  const std::string name = arguments.hand.empty() ? lab->text("mapping.hand") : arguments.hand;
  if (name.empty()) return wrong_use("names no hand", "--hand", model::hand_hint());
  const auto judged = load(arguments, name);
  if (!judged) return tl::unexpected(judged.error());
  if (!arguments.write_to.empty()) {
    if (auto done = write_takes(*judged, arguments.write_to); !done)
      return tl::unexpected(done.error());
    return exit_done;
  }
  std::vector<TrialResult> all;
  for (const BenchmarkedMode& mode : *modes) {
    auto results = mode.mode == BenchmarkMode::external
                       ? judge_external(*judged, arguments, *lab)
                       : judge_own(*judged, mode, arguments.threads);
    if (!results) return tl::unexpected(results.error());
    std::ranges::move(*results, std::back_inserter(all));
  }
  if (!arguments.out.empty()) {
    std::error_code ignored;
    std::filesystem::create_directories(arguments.out, ignored);
    if (auto done = write_file(std::filesystem::path(arguments.out) / "benchmark.csv", to_csv(all));
        !done)
      return tl::unexpected(done.error());
  }
  const auto summaries = summarise(all);
  if (!arguments.json) {
    std::cout << to_table(summaries);
    return exit_done;
  }
  nlohmann::ordered_json document{{"grasp_benchmark", nlohmann::ordered_json::array()}};
  for (const ModeSummary& one : summaries) document["grasp_benchmark"].push_back(to_json(one));
  std::cout << document.dump(2) << '\n';
  return exit_done;
}

}  // namespace

int benchmark_command(const std::vector<std::string>& texts) {
  log::set_name("benchmark");
  Arguments arguments;
  CLI::App app{
      "Judges mappings by the same takes: people who reach for objects in a simulated world. Any\n"
      "process that reads hand/posture and writes robot/command can enter. Exit code 0: done, 2:\n"
      "wrong use, 3: something is missing, or nobody answers.",
      "prehend benchmark"};
  arguments.add_to(app);
  if (const auto code = service::parse(app, texts)) return *code;
  const auto code = judge_all(arguments);
  return code ? *code : service::complain(code.error());
}

}  // namespace prehend::mapping
