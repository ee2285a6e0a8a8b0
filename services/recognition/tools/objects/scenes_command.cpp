// `prehend objects scenes`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/log.hpp"
#include "common/base/progress.hpp"
#include "common/base/to_terminal.hpp"
#include "common/service/arguments.hpp"
#include "services/recognition/core/detection/verdict.hpp"
#include "services/recognition/core/learning/logistic.hpp"
#include "services/recognition/files/model_file.hpp"
#include "services/recognition/service/service.hpp"
#include "services/recognition/tools/objects/commands.hpp"
#include "services/recognition/tools/trials/roc.hpp"

namespace prehend::recognition {
namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  service::LabArguments lab;
  std::vector<std::string> kinds;
  std::string roc, list;
  int count = 40;
  std::uint64_t seed = 1;
  std::vector<std::uint64_t> strangers;
  bool distances = false, fit = false, json = false;
};

constexpr std::array all_kinds{Trial::open,     Trial::clutter, Trial::light,
                               Trial::occluded, Trial::empty,   Trial::strangers};

double degrees(double rad) {
  return rad * 180 / 3.14159265358979;
}

Json to_json(const TrialSummary& s) {
  Json made{{"kind", to_string(s.trial)},
            {"scenes", s.scenes},
            {"frames_with_false_alarm", s.frames_with_false_alarm}};
  if (s.trial == Trial::empty || s.trial == Trial::strangers) return made;
  made["detected"] = s.detected;
  made["error_median_m"] = s.error_median;
  made["error_95_m"] = s.error_95;
  made["error_worst_m"] = s.error_worst;
  made["turn_median_rad"] = s.turn_median;
  made["normalised_squared_error"] = s.normalised;
  made["normalised_squared_turn"] = s.normalised_turn;
  made["within_95"] = s.within_95;
  made["misses"] = Json::object();
  for (const auto& [cause, count] : s.misses) made["misses"][to_string(cause)] = count;
  return made;
}

void print(const std::vector<TrialSummary>& rows) {
  to_terminal(
      "| scenes | | detected | error median, mm | 95 % | worst | turn median, ° | "
      "error²/σ² (2) | turn²/σ² (1) | in 95 % ellipse | frames with false alarm |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const TrialSummary& s : rows) {
    if (s.trial == Trial::empty || s.trial == Trial::strangers) {
      to_terminal("| {} | {} | | | | | | | | | {} |\n", to_string(s.trial), s.scenes,
                  s.frames_with_false_alarm);
      continue;
    }
    to_terminal(
        "| {} | {} | {:.1f} % | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.0f} % "
        "| {} |\n",
        to_string(s.trial), s.scenes, 100.0 * s.detected / std::max(1, s.scenes),
        1000 * s.error_median, 1000 * s.error_95, 1000 * s.error_worst, degrees(s.turn_median),
        s.normalised, s.normalised_turn, 100 * s.within_95, s.frames_with_false_alarm);
  }
}

/// Why targets were missed.
void print_misses(const std::vector<TrialSummary>& rows) {
  constexpr std::array causes{Miss::search, Miss::no_outline, Miss::named, Miss::colours,
                              Miss::outline};
  if (std::all_of(rows.begin(), rows.end(), [](const auto& s) { return s.misses.empty(); })) return;
  to_terminal("\n| missed |");
  for (const Miss cause : causes) to_terminal(" {} |", to_string(cause));
  to_terminal("\n|---|---|---|---|---|---|\n");
  for (const TrialSummary& s : rows) {
    if (s.misses.empty()) continue;
    to_terminal("| {} |", to_string(s.trial));
    for (const Miss cause : causes) {
      const auto count = s.misses.find(cause);
      to_terminal(" {} |", count == s.misses.end() ? 0 : count->second);
    }
    to_terminal("\n");
  }
}

void print_roc(const std::vector<TrialResult>& results) {
  to_terminal(
      "\n| least probability | targets detected | frames of {} with a false alarm |\n"
      "|---|---|---|\n",
      results.size());
  for (const double threshold : roc_thresholds) {
    const RocPoint at = roc_at(threshold, results);
    to_terminal("| {:.2f} | {:.1f} % | {:.2f} % |\n", threshold, 100 * at.detected,
                100 * at.alarms);
  }
}

/// The verdict's weights that suit these scenes best: fitted to all that was measured as an object.
SignRow fit_verdict(const std::vector<TrialResult>& results, Json& report) {
  std::vector<std::pair<SignRow, bool>> seen;
  const auto add = [&](const std::vector<Sighting>& sightings, bool right) {
    for (const Sighting& s : sightings)
      seen.push_back({row({s.by_colours, s.agreement, s.contrast, s.measured, s.hidden}), right});
  };
  for (const TrialResult& r : results) {
    add(r.true_ones, true);
    add(r.false_alarms, false);
  }
  const auto n = static_cast<Eigen::Index>(seen.size());
  Eigen::MatrixXd rows(n, SignRow::RowsAtCompileTime);
  Eigen::VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    rows.row(i) = seen[static_cast<std::size_t>(i)].first.transpose();
    right[i] = seen[static_cast<std::size_t>(i)].second ? 1 : 0;
  }
  const SignRow made = logistic_fit(rows, right, Eigen::VectorXd::Ones(n));
  report["fit"] = {{"objects", right.sum()},
                   {"others", static_cast<double>(n) - right.sum()},
                   {"weights", std::vector<double>(made.begin(), made.end())}};
  return made;
}

/// Looks at scenes of a kind with one detector, and keeps a line of each.
class Trials {
 public:
  Trials(const Arguments& arguments, const model::Catalogue& catalogue, const Detector& detector)
      : arguments_(arguments), catalogue_(catalogue), detector_(detector) {
    if (arguments.list.empty()) return;
    list_.open(arguments.list);
    list_ << "kind,seed,target,probability,error_mm,turn_deg,distance_m,normalised,normalised_turn,"
             "agreement,contrast,width,height,hidden,by_colours,miss,false_alarms\n";
  }

  std::vector<TrialResult> look(Trial kind, const CameraModel& camera, Progress& progress) {
    std::vector<TrialResult> results;
    const auto count = static_cast<std::size_t>(arguments_.count);
    const std::vector<std::uint64_t> sets =
        arguments_.strangers.empty() ? std::vector<std::uint64_t>{7001} : arguments_.strangers;
    std::optional<TrialScenes> scenes;
    for (std::size_t k = 0; k < count * sets.size(); ++k) {
      if (k % count == 0) scenes.emplace(catalogue_, camera, sets[k / count]);
      const std::uint64_t seed = arguments_.seed + k;
      if (const auto scene = scenes->make(kind, seed)) {
        results.push_back(try_scene(detector_, camera, *scenes, *scene));
        results.back().trial = kind;
        results.back().seed = seed;
        if (list_.is_open()) list(results.back());
      }
      progress.show(k + 1, count * sets.size());
    }
    return results;
  }

 private:
  void list(const TrialResult& r) {
    list_ << fmt::format(
        "{},{},{},{:.3f},{:.1f},{:.1f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},"
        "{:.2f},{:.3f},{}",
        to_string(r.trial), r.seed, r.target, r.probability, 1000 * r.error, degrees(r.turn_error),
        r.distance, r.normalised, r.normalised_turn, r.agreement, r.contrast, r.measured.x(),
        r.measured.y(), r.hidden, r.by_colours, to_string(r.miss));
    for (const Sighting& alarm : r.false_alarms)
      list_ << fmt::format(",{} {:.3f} {:.2f} {:.2f} {:.2f} {:.2f} {:.3f}", alarm.name,
                           alarm.probability, alarm.agreement, alarm.contrast, alarm.measured.x(),
                           alarm.measured.y(), alarm.by_colours);
    list_ << std::endl;
  }

  const Arguments& arguments_;
  const model::Catalogue& catalogue_;
  const Detector& detector_;
  std::ofstream list_;
};

/// The error at distances: the lab's camera, nearer or further along the line on which it looks at
/// the table's middle.
Json at_distances(const Arguments& arguments, const CameraModel& lab_camera, double accept,
                  Trials& trials) {
  Json rows = Json::array();
  if (!arguments.json)
    to_terminal(
        "\n| distance, m | detected | error median, mm | 95 % | turn median, ° | error²/σ² "
        "(2) |\n|---|---|---|---|---|---|\n");
  for (const double d : {0.6, 0.8, 1.0, 1.2, 1.5, 2.0}) {
    CameraModel camera = lab_camera;
    const Eigen::Vector3d middle(0, -0.05, 0.05);
    camera.X_WC =
        look_at(middle + d * (lab_camera.X_WC.translation() - middle).normalized(), middle);
    Progress progress(fmt::format("{} m", d));
    const TrialSummary s =
        summarise(Trial::open, trials.look(Trial::open, camera, progress), accept);
    Json row = to_json(s);
    row["distance_m"] = d;
    rows.push_back(row);
    if (!arguments.json)
      to_terminal("| {:.1f} | {:.0f} % | {:.1f} | {:.1f} | {:.1f} | {:.1f} |\n", d,
                  100.0 * s.detected / std::max(1, s.scenes), 1000 * s.error_median,
                  1000 * s.error_95, degrees(s.turn_median), s.normalised);
  }
  return rows;
}

int run(const Arguments& arguments) {
  const auto config = arguments.lab.load();
  if (!config) return service::complain(config.error(), exit_wrong_use);
  const auto lab_camera = configured_camera(*config);
  if (!lab_camera) return broken(lab_camera.error());
  const auto catalogue = model::Catalogue::load(config->path("lab.catalogue"));
  if (!catalogue) return broken(catalogue.error());
  auto models = load_models(config->path("recognition.model"));
  if (!models) return broken(models.error());
  DetectorOptions options;
  options.accept = config->number("recognition.accept");
  options.doubtful = arguments.fit ? 1e-9 : arguments.roc.empty() ? 1 : 0.02;
  const Detector detector(std::move(*models), *catalogue, options);
  Trials trials(arguments, *catalogue, detector);

  std::vector<TrialResult> results;
  std::vector<TrialSummary> rows;
  for (const Trial kind : all_kinds) {
    const auto& wanted = arguments.kinds;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), to_string(kind)) == wanted.end())
      continue;
    Progress progress(to_string(kind));
    const auto these = trials.look(kind, *lab_camera, progress);
    results.insert(results.end(), these.begin(), these.end());
    rows.push_back(summarise(kind, results, options.accept));
  }
  Json report{{"accept", options.accept}, {"kinds", Json::array()}};
  if (arguments.fit) {
    const SignRow weights = fit_verdict(results, report);
    if (!arguments.json)
      to_terminal(
          "verdict fitted to {} objects and {} things measured as one:\n"
          "  const SignRow weights{{{:.1f}}};\n\n",
          report["fit"]["objects"].get<double>(), report["fit"]["others"].get<double>(),
          fmt::join(weights, ", "));
  }
  for (const TrialSummary& row : rows) report["kinds"].push_back(to_json(row));
  if (!arguments.json) {
    print(rows);
    print_misses(rows);
    if (!arguments.roc.empty()) print_roc(results);
  }
  if (arguments.distances)
    report["distances"] = at_distances(arguments, *lab_camera, options.accept, trials);
  if (!arguments.roc.empty())
    if (const auto drawn = draw_roc(results, arguments.roc); !drawn) return broken(drawn.error());
  if (arguments.json) std::cout << report << "\n";
  return exit_done;
}

}  // namespace

void add_scenes(tool::Program& program) {
  auto a = std::make_shared<Arguments>();
  CLI::App* command = program.app().add_subcommand(
      "scenes", "How well objects are found and placed in rendered scenes, whose truth is known.");
  a->lab.add_to(*command);
  command->add_option("--count", a->count, "scenes of each kind")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--seed", a->seed, "of the first scene")->capture_default_str();
  command
      ->add_option("--strangers", a->strangers,
                   "seed of what the strangers are, 7001; repeatable: so many scenes with each")
      ->type_size(1)
      ->allow_extra_args(false);
  command
      ->add_option("--kind", a->kinds,
                   "open, clutter, light, occluded, empty or strangers; repeatable; default: all")
      ->check(CLI::IsMember({"open", "clutter", "light", "occluded", "empty", "strangers"}))
      ->type_size(1)
      ->allow_extra_args(false);
  command->add_flag("--distances", a->distances, "also the error at distances from 0.6 to 2 m");
  command->add_option("--roc", a->roc,
                      "png of the targets detected against false alarms (by gnuplot), and a table");
  command->add_flag("--fit", a->fit,
                    "fits the verdict on what was measured as an object, and prints its weights");
  command->add_option("--list", a->list, "csv with a line a scene");
  command->add_flag("--json", a->json, "one JSON document");
  program.on(*command, [a] { return run(*a); });
}

}  // namespace prehend::recognition
